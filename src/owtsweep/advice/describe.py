"""The words of an advice, metres first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.advice.answer import Answer
from owtsweep.advice.found import Error
from owtsweep.advice.levers import RECORDS, Pulled
from owtsweep.advice.question import Question
from owtsweep.advice.worlds import Turned
from owtsweep.results.answer import tell_cell
from owtsweep.results.criteria import Criterion, show_error

#: What stands before the levers.
HEADING_OF_LEVERS = (
    f"What would lessen the error (over {RECORDS} records each; times the error without it):"
)
#: What stands before the other worlds.
HEADING_OF_WORLDS = (
    "What if the world is another, and schemes are told what they were told "
    f"(over {RECORDS} records each; times the least error there):"
)
#: What is said of the best contender, by verdict.
VERDICTS = {
    "won": "It is best.",
    "tie": "It is the simplest of those that are within the margin.",
    "open": "It is best so far, and not decided.",
}


def tell_question(question: Question) -> list[str]:
    """Return what is asked, and of which tuning, truth, records and seed the answer speaks."""
    origin = question.study.describe_origin(question.config)
    return [f"Asked: {question.tell()}.", *([origin] if origin else [])]


def tell_answer(given: Answer) -> list[str]:
    """Return the answer as sentences: the best contender first, then what stands beside it."""
    found, criterion = given.found, given.found.criterion
    of_cell = tell_cell(found.cells, found.tables["ratios"], criterion)
    verdict = VERDICTS[str(found.cells["verdict"].iloc[0])]
    baseline = " (no estimator)" if given.best in found.contents.baselines else ""
    first = f"Run {given.best}{baseline}: its error is {_show(given.error, criterion)}. {verdict}"
    further = [line for line in found.contents.answer if line not in of_cell]
    return [
        first,
        f"Judged by {criterion.title}.",
        *of_cell[1:],
        _tell_simplest(given),
        *_tell_bound(given),
        *further,
    ]


def tell_closer(closer: Error, given: Answer) -> str:
    """Return the error of the advised contender over more records, in a sentence."""
    error = _show(closer, given.found.criterion)
    return f"Over more records the error of {given.best} is {error}."


def _show(error: Error, criterion: Criterion) -> str:
    records = f"{error.n} record{'s' * (error.n != 1)}"
    if not np.isfinite(error.low):
        return f"{criterion.show(error.value)} ({records})"
    ends = f"{show_error(error.low)} to {show_error(error.high)}"
    return f"{criterion.show(error.value)} (95 %: {ends}; {records})"


def _show_times(ratio: float, low: float, high: float) -> str:
    ends = f" (95 %: {show_error(low)} to {show_error(high)})" if np.isfinite(low) else ""
    return f"{show_error(ratio)} times{ends}"


def _tell_bound(given: Answer) -> list[str]:
    if given.bound is None:
        return []
    least = given.found.criterion.show(given.bound)
    return [f"Bound: no linear estimator that knows the spectrum has less than {least}."]


def _tell_simplest(given: Answer) -> str:
    margin = f"{100.0 * given.margin:.3g} %"
    if given.simplest == given.best:
        return f"No simpler one is within {margin} of {given.best}."
    error = given.found.criterion.show(given.simplest_error)
    return f"Simplest within {margin} of {given.best}: {given.simplest}, {error}."


def tell_pulled(pulled: Pulled, given: Answer) -> str:
    """Return in a line what a lever brings."""
    start = f"{pulled.words[0].upper()}{pulled.words[1:]} ({pulled.change}):"
    if pulled.ratio is None:
        return f"{start} cannot be tried: {pulled.refused}"
    ratio = pulled.ratio
    times = _show_times(ratio.value, ratio.low, ratio.high)
    return f"{start} {pulled.best}, {given.found.criterion.show(pulled.error)}, {times}."


def tell_nominal(given: Answer) -> str:
    """Return in a line the error as asked, over the records of the other worlds."""
    error = given.found.measure(given.best, RECORDS).value
    return f"As asked (nominal): {given.best}, {given.found.criterion.show(error)}."


def tell_turned(turned: Turned, given: Answer) -> str:
    """Return in a line what the advice turns to in another world."""
    start = f"{turned.sentence[0].upper()}{turned.sentence[1:]} ({turned.world}):"
    if turned.refused:
        return f"{start} cannot be tried: {turned.refused}"
    show = given.found.criterion.show
    if not np.isfinite(turned.error):
        return f"{start} {given.best} has no result; run {turned.best}, {show(turned.least)}."
    if turned.best == given.best:
        after = f"; next {turned.second}, {show_error(turned.ratio)} times" * bool(turned.second)
        return f"{start} {given.best} stays best, {show(turned.error)}{after}."
    times = _show_times(turned.regret, turned.low, turned.high)
    return (
        f"{start} {given.best} has {show(turned.error)}, {times} that of the best, "
        f"{turned.best}, {show(turned.least)}."
    )


def tell_most(levers: Sequence[Pulled]) -> str:
    """Return in a sentence which lever buys most; "" if none could be tried."""
    ratios = {each.words: each.ratio.value for each in levers if each.ratio is not None}
    if not ratios:
        return ""
    most = min(ratios, key=ratios.__getitem__)
    if ratios[most] >= 1.0:
        return "None of these lessens the error."
    tried = "Most" if len(ratios) == len(levers) else "Of those that could be tried, most"
    return f"{tried} is bought by: {most} ({ratios[most]:.3g} times the error)."
