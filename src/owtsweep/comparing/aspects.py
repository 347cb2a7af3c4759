"""A study's description of a run, used to compare the run with others."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from owtsweep.results.conditions import Condition, Grid

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, kw_only=True)
class Aspects:
    """The properties of a run that a comparison needs.

    Attributes
    ----------
    conditions, grid
        The study's conditions, and the run's values of each.
    schemes
        Names of the schemes, in order.
    criterion, window
        The measure and the window by which the run judges.
    pairing
        Key -> its value, for the keys that determine the records together with conditions and
        replicate. If they are equal in two runs, equal replicates are compared in pairs.
    boundary
        Two schemes: the first is better below and the second above a boundary along the condition
        that expands. None if no boundary is of interest.
    best_of
        Makes the best-scheme table of a run whose rows are not samples, from rows, common values of
        the conditions, schemes and criterion; None if they are samples.
    """

    conditions: tuple[Condition, ...]
    grid: Grid
    schemes: Sequence[str]
    criterion: str
    window: str
    pairing: Mapping[str, Any]
    boundary: tuple[str, str] | None = None
    best_of: Callable[[pd.DataFrame, Grid, Sequence[str], str], pd.DataFrame] | None = None

    @property
    def names(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.conditions]

    @property
    def size(self) -> int:
        """The number of cells."""
        return math.prod(len(self.grid[name]) for name in self.names)
