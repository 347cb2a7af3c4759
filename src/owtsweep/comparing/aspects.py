"""What a study says about a run so that it can be compared with others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from owtsweep.results.conditions import Condition, Grid

if TYPE_CHECKING:
    import pandas as pd

#: Rows, common values of the conditions, schemes, criterion -> the best-scheme table.
BestOf = Callable[["pd.DataFrame", Grid, Sequence[str], str], "pd.DataFrame"]


@dataclass(frozen=True, kw_only=True)
class Aspects:
    """A run as a comparison sees it.

    Attributes
    ----------
    conditions, grid
        The study's conditions and the run's values of them.
    schemes
        Names in their order.
    criterion, window
        What the run judges by.
    pairing
        Key -> its value, for the keys that decide the records beside conditions and replicate.
        If they are equal in two runs, equal replicates are compared in pairs.
    boundary
        Two schemes: the first is better below and the second above a boundary along the condition
        that expands. None if no boundary is of interest.
    best_of
        Makes the best-scheme table of a run whose rows are not samples; None where they are.
    """

    conditions: tuple[Condition, ...]
    grid: Grid
    schemes: Sequence[str]
    criterion: str
    window: str
    pairing: Mapping[str, Any]
    boundary: tuple[str, str] | None = None
    best_of: BestOf | None = None
