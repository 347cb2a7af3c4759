"""The levers of an advice: changes of one key each, and what they would make of the error.

A lever is run on the first records of the same numbers, so that ratios of errors are paired.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from owtsweep.advice.answer import Answer
from owtsweep.advice.found import Error, divide, find
from owtsweep.advice.question import Question
from owtsweep.config import as_mapping, get_key
from owtsweep.config.typed import value_at
from owtsweep.errors import InputError
from owtsweep.statistics.deciding import FIRST

#: Records of a lever: those of a first look, which all contenders of the answer have too.
RECORDS = FIRST
#: A scheme whose error is larger than the least one by this factor takes no part.
FAR = 2.0


class Pulled(NamedTuple):
    """What a lever brings: the best contender with it, its error, and the ratio to that without.

    words: what is done. change: the override that does it.
    refused: why it cannot be tried; "" if it was.
    """

    words: str
    change: str
    best: str = ""
    error: float = float("nan")
    ratio: Error | None = None
    refused: str = ""


def pull_levers(question: Question, given: Answer) -> Iterator[Pulled]:
    """Yield what each lever of the study brings to a case, as soon as it is computed."""
    plain, schemes = as_mapping(question.config), list_near(question, given)
    for lever in question.study.levers:
        value: Any = value_at(plain, lever.key)
        axis = isinstance(value, list)  # of a grid, with one value
        old = value[0] if axis else value
        new = lever.change(old)
        if new is None:
            continue
        tries = (
            _pull(question, given, lever.words, _name_change(lever.key, one, axis=axis), schemes)
            for one in (new, *(factor * old for factor in lever.near))
        )
        first = next(tries)
        moved = next((one for one in tries if not one.refused), None) if first.refused else None
        yield first if moved is None else moved._replace(words=f"nearly {lever.words}")


def _name_change(key: str, new: float | str, *, axis: bool) -> str:
    text = new if isinstance(new, str) else f"{new:.6g}"
    return f"{key}=[{text}]" if axis else f"{key}={text}"


def _pull(
    question: Question, given: Answer, words: str, change: str, schemes: Sequence[str]
) -> Pulled:
    """Run the case with a change; `schemes` is what `list_near` returns."""
    try:
        config = question.change(change, *schemes, f"grid.replicates={RECORDS}")
        found = find(question.study, config)
    except InputError as error:
        return Pulled(words, change, refused=str(error))
    best = found.find_best(RECORDS)
    without = given.found.values[given.best][:RECORDS]
    ratio = divide(found.values[best][: len(without)], without, found.criterion)
    return Pulled(words, change, best, found.measure(best).value, ratio)


def list_near(question: Question, given: Answer) -> list[str]:
    """Return the override that leaves out schemes far from the best; [] if the user listed some."""
    if "schemes" in map(get_key, question.given):
        return []
    contents, ratios = given.found.contents, given.found.tables["ratios"]
    near = {given.best, *ratios.loc[ratios["ratio"] <= FAR, "scheme"]}
    names = [name for name in contents.contenders if name not in contents.baselines]
    return [f"schemes=[{','.join([name for name in names if name in near] or names[:1])}]"]
