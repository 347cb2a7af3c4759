"""The description of a run that a study makes, so that runs can be compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from owtsweep.results.conditions import Condition, Grid

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, kw_only=True)
class Aspects:
    """The properties of a run that a comparison needs.

    Attributes
    ----------
    conditions
        The conditions of the study, i.e. the axes of its grid.
    grid
        Name of a condition -> the run's values of this condition.
    schemes
        Names of the run's schemes, in the study's order.
    criterion
        The measure by which the run judges its schemes, e.g. "position" for the mean squared
        position error.
    window
        The part of each record over which the criterion is averaged: "full" or "settled".
    pairing
        Configuration key -> its value, for all keys that determine the motion and noise of the
        records. If two runs agree in all these values, records with equal conditions and replicate
        are equal too, and the runs are compared record by record.
    boundary
        Names of two schemes: the first is expected to be better at small values of the last
        condition, the second at large values. None if no two schemes are expected to differ so.
    origin
        Name of a setting -> its value in words, for the settings that a reader must know to read
        the run's numbers: tuning, truth, records per cell and seed. It is shown in titles.
    score
        What the number is called by which schemes are judged.
    beside
        Names of the run's baselines, which a comparison leaves out.
    best_of
        For a run with expected values instead of records: a function that makes the table of best
        schemes. The arguments of the function are the run's rows, the values of the conditions
        that all compared runs have, the names of the schemes, and the criterion. None for a run
        with records.
    """

    conditions: tuple[Condition, ...]
    grid: Grid
    schemes: Sequence[str]
    criterion: str
    window: str
    pairing: Mapping[str, Any]
    boundary: tuple[str, str] | None = None
    origin: Mapping[str, str] = field(default_factory=dict)
    score: str = "MSE"
    beside: Sequence[str] = ()
    best_of: Callable[[pd.DataFrame, Grid, Sequence[str], str], pd.DataFrame] | None = None

    @property
    def names(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.conditions]

    @property
    def size(self) -> int:
        """The number of cells; a cell is a combination of one value of each condition."""
        return math.prod(len(self.grid[name]) for name in self.names)
