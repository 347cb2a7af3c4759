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
        The measure by which the run judges its schemes, e.g. position, and the part of each record
        over which this measure is averaged ("full" or "settled").
    pairing
        Configuration key -> its value. These keys, with conditions and replicate, determine a
        record's motion and noise. Two runs in which all these values are equal have the same
        records, so their replicates are compared in pairs.
    boundary
        Names of two schemes: the first is expected to be better below, and the second above, a
        value of the condition that expands (`Condition.expands`). None if there is no such pair.
    best_of
        Function that makes the best-scheme table of a run with expected values instead of records.
        Its arguments are the run's rows, the common values of the conditions, the schemes and the
        criterion. None for a run with records.
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
        """The number of cells, i.e. combinations of values of the conditions."""
        return math.prod(len(self.grid[name]) for name in self.names)
