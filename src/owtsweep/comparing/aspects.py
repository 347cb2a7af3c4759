"""A study's description of a run, used to compare the run with others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from owtsweep.results.conditions import Condition, Grid

if TYPE_CHECKING:
    import pandas as pd

#: Function of rows, common values of the conditions, schemes and criterion that returns the
#: best-scheme table.
BestOf = Callable[["pd.DataFrame", Grid, Sequence[str], str], "pd.DataFrame"]


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
        Makes the best-scheme table of a run whose rows are not samples; None if they are samples.
    """

    conditions: tuple[Condition, ...]
    grid: Grid
    schemes: Sequence[str]
    criterion: str
    window: str
    pairing: Mapping[str, Any]
    boundary: tuple[str, str] | None = None
    best_of: BestOf | None = None
