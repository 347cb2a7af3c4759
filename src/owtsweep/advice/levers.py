"""The levers of an advice: changes of one key each, and what they would make of the error.

A lever is run on the first records of the same numbers, so that ratios of errors are paired.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from owtsweep.advice.answer import Answer
from owtsweep.advice.found import Error, divide, find
from owtsweep.advice.question import Question
from owtsweep.config import as_mapping, get_key
from owtsweep.config.typed import value_at
from owtsweep.errors import InputError
from owtsweep.statistics.deciding import FIRST
from owtsweep.sweep.levers import Lever

#: Records of a lever: those of a first look, which all contenders of the answer have too.
RECORDS = FIRST
#: A scheme whose error is larger than the least one by this factor takes no part.
FAR = 2.0


class Pulled(NamedTuple):
    """What a lever brings: the best contender with it, its error, and the ratio to that without.

    change: the override. refused: why it cannot be tried; "" if it was.
    """

    lever: Lever
    change: str
    best: str = ""
    error: float = float("nan")
    ratio: Error | None = None
    refused: str = ""


def pull_levers(question: Question, given: Answer) -> Iterator[Pulled]:
    """Yield what each lever of the study brings to a case, as soon as it is computed."""
    plain, near = as_mapping(question.config), list_near(question, given)
    for lever in question.study.levers:
        value: Any = value_at(plain, lever.key)
        axis = isinstance(value, list)  # of a grid, with one value
        new = lever.change(value[0] if axis else value)
        if new is None:
            continue
        text = new if isinstance(new, str) else f"{new:.6g}"
        change = f"{lever.key}=[{text}]" if axis else f"{lever.key}={text}"
        try:
            config = question.change(change, *near, f"grid.replicates={RECORDS}")
            found = find(question.study, config)
        except InputError as error:
            yield Pulled(lever, change, refused=str(error))
            continue
        best = found.find_best(RECORDS)
        without = given.found.values[given.best][:RECORDS]
        ratio = divide(found.values[best][: len(without)], without, found.criterion)
        yield Pulled(lever, change, best, found.measure(best).value, ratio)


def list_near(question: Question, given: Answer) -> list[str]:
    """Return the override that leaves out schemes far from the best; [] if the user listed some."""
    if "schemes" in map(get_key, question.given):
        return []
    contents, ratios = given.found.contents, given.found.ratios
    near = {given.best, *ratios.loc[ratios["ratio"] <= FAR, "scheme"]}
    names = [name for name in contents.contenders if name not in contents.baselines]
    return [f"schemes=[{','.join([name for name in names if name in near] or names[:1])}]"]
