"""The advice in other worlds: what it turns to where the truth is not what schemes are told.

Each world is run by the key `over`: its truth departs, and schemes know what they knew before.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.advice.answer import Answer
from owtsweep.advice.found import find
from owtsweep.advice.levers import RECORDS
from owtsweep.advice.question import Question
from owtsweep.config.over import NOMINAL
from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


#: Worlds that are run together: enough to keep some cores busy, so few that lines come soon.
AT_ONCE = 4
#: Columns of the table "regret" that `Turned` has of the nominal world's best contender.
ERRORS = ("error", "regret", "low", "high")


class Turned(NamedTuple):
    """What the advice turns to in another world.

    world, sentence: its name, and how it departs.
    refused: why it cannot be tried; "" if it was.
    best, least: who is best in this world, and its error.
    second, ratio: who comes next there, and its error over the least; "" and NaN without one.
    error: of the contender that is best in the nominal world; NaN where it has none.
    regret, low, high: `error` over `least`, with its range.
    """

    world: str
    sentence: str
    refused: str = ""
    best: str = ""
    least: float = float("nan")
    second: str = ""
    ratio: float = float("nan")
    error: float = float("nan")
    regret: float = float("nan")
    low: float = float("nan")
    high: float = float("nan")


def try_worlds(question: Question, given: Answer) -> Iterator[Turned]:
    """Yield what the advice turns to in each world of the study, some at a time as computed."""
    worlds = [*question.study.list_worlds(question.config)]
    for first in range(0, len(worlds), AT_ONCE):
        yield from _try(question, given, worlds[first : first + AT_ONCE])


def _try(question: Question, given: Answer, worlds: Sequence[str]) -> Iterator[Turned]:
    sentences = question.study.list_worlds(question.config)
    try:
        table = _run(question, worlds)["regret"]
    except InputError as error:  # of one of them
        if len(worlds) == 1:
            yield Turned(worlds[0], sentences[worlds[0]], refused=str(error))
        else:
            for world in worlds:
                yield from _try(question, given, [world])
        return
    for world in worlds:
        yield _tell_apart(table, world, sentences[world], given)


def _tell_apart(table: pd.DataFrame, world: str, sentence: str, given: Answer) -> Turned:
    lines = table[table["world"] == world].set_index("scheme")
    row: Mapping[Hashable, Any] = lines.iloc[0].to_dict()
    own: Mapping[Hashable, Any] = lines.to_dict("index").get(given.best, {})
    best, least = str(row["best"]), float(row["least"])
    errors = [float(own.get(name, np.nan)) for name in ERRORS]
    others = lines["error"].drop(best).dropna()
    second = str(others.idxmin()) if len(others) else ""
    ratio = float(others.min()) / least if second else np.nan
    return Turned(world, sentence, "", best, least, second, ratio, *errors)


def join_worlds(question: Question, worlds: list[str]) -> Mapping[str, pd.DataFrame]:
    """Return the tables "regret" and "regret_summary" over the nominal and some other worlds."""
    return _run(question, [NOMINAL, *worlds])


def _run(question: Question, worlds: Sequence[str]) -> Mapping[str, pd.DataFrame]:
    words = f"over={{world: [{','.join(worlds)}]}}", f"grid.replicates={RECORDS}"
    return find(question.study, question.change(*words)).tables
