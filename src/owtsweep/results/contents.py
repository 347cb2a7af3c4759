"""What a study shows of a run: the answer in words, and the map with all that it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Contents:
    """What a study shows of a run of one tuning.

    origin: Lines on tuning, truth, sensors, records and seed.
    answer: Sentences: who is best where, how good that is, and what is open.
    conditions: the study's conditions, with the two first that a map has as axes.
    criteria: the measures of best_scheme.csv; the first one decided how many records a cell has.
    window: the window that was judged.
    contenders: Names of schemes and baselines, the simplest first.
    baselines: Names of those that are no schemes.
    cube: the values of all contenders.
    cells: rows of best_scheme.csv as a map shows them. Where baselines do not compete, one that has
        less error than every scheme stands in the place of the best.
    """

    origin: Sequence[str]
    answer: Sequence[str]
    conditions: Sequence[Condition]
    criteria: Mapping[str, Criterion]
    window: str
    contenders: Sequence[str]
    baselines: Sequence[str]
    cube: Cube
    cells: pd.DataFrame
