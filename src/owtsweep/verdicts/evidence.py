"""A run's evidence on published results: the values of its cells, looked up by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.statistics.contest import find_alike, find_least

if TYPE_CHECKING:
    import pandas as pd

#: A published condition and one of the run are the same if they agree to this many decimal places.
DIGITS = 9
#: A cell: one number per condition, in the order of the conditions.
Cell = tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The cases of a run in one window.

    Attributes
    ----------
    rows
        The run's cases, as `Run.cases` returns them.
    conditions, grid, schemes
        The conditions, their values and the schemes of the run as planned; all values are numbers.
    rivals
        The schemes that the publication compares.
    window
        E.g. "full" or "settled".
    """

    rows: pd.DataFrame
    conditions: Sequence[Condition]
    grid: Grid
    schemes: tuple[str, ...]
    rivals: tuple[str, ...]
    window: str

    @cached_property
    def finished(self) -> pd.DataFrame:
        """The rows of finished cases, in all windows."""
        return self.rows[self.rows["status"] == OK]

    @cached_property
    def values(self) -> pd.DataFrame:
        """One value per scheme, cell, measure and replicate, in the chosen window."""
        inside = self.rows[self.rows["window"] == self.window]
        schemes = list(inside["scheme"].unique())
        return Cube.of_rows(inside, schemes, self.conditions, self.grid).to_table()

    @cached_property
    def _by_case(self) -> dict[tuple[Any, ...], tuple[Array, Array]]:
        """(scheme, measure, *cell) -> replicates in order, and their values in the window."""
        values = self.values.sort_values("replicate", kind="stable")
        replicate, value = values["replicate"].to_numpy(), values["value"].to_numpy()
        names = [condition.name for condition in self.conditions]
        exact = values.round(dict.fromkeys(names, DIGITS))
        groups: dict[Any, Any] = exact.groupby(["scheme", "measure", *names]).indices
        return {case: (replicate[index], value[index]) for case, index in groups.items()}

    def common(self, keys: Sequence[tuple[str, Cell, str]]) -> list[Array] | None:
        """(replicates,) for each (scheme, cell, measure), over the replicates that all share.

        Returns None if one has no values or if no replicate is common to all.
        """
        cases = []
        for scheme, cell, measure in keys:
            case = self._by_case.get((scheme, measure, *(round(number, DIGITS) for number in cell)))
            if case is None:
                return None
            cases.append(case)
        shared = cases[0][0]
        for replicates, _ in cases[1:]:
            shared = np.intersect1d(shared, replicates, assume_unique=True)
        if not len(shared):
            return None
        return [values[np.isin(replicates, shared)] for replicates, values in cases]

    def paired(
        self, schemes: Sequence[str], cell: Cell, measure: str = "position"
    ) -> dict[str, Array] | None:
        """Scheme -> (replicates,) in one cell, over the replicates that all of them finished."""
        values = self.common([(scheme, cell, measure) for scheme in schemes])
        return None if values is None else dict(zip(schemes, values, strict=True))

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """(replicates,) values of one scheme, or None."""
        values = self.common([(scheme, cell, measure)])
        return None if values is None else values[0]

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """The best other rival by mean position MSE, with its values and those of `scheme`.

        As in the map, a scheme that coincides with `scheme` does not count as another one, and
        other schemes that coincide appear under the last of their names.

        Returns
        -------
        (name, (replicates,) of `scheme`, (replicates,) of the other), or None where one of the
        rivals is missing or all of them coincide.
        """
        paired = self.paired(self.rivals, cell)
        if paired is None:
            return None
        means, alike = _one_cell(paired)
        others = ~alike[self.rivals.index(scheme)]
        if not others.any():
            return None
        best = self.rivals[int(find_least(means, others, alike)[0][0])]
        return best, paired[scheme], paired[best]


def find_best(paired: Mapping[str, Array]) -> str:
    """The scheme of least mean; of coinciding schemes the last, as in the map."""
    means, alike = _one_cell(paired)
    return list(paired)[int(find_least(means, np.ones(means.shape, dtype=bool), alike)[0][0])]


def _one_cell(paired: Mapping[str, Array]) -> tuple[Array, NDArray[np.bool_]]:
    """Means (schemes, 1) and whether two schemes coincide (schemes, schemes, 1)."""
    values = np.array(list(paired.values()))[:, np.newaxis]
    means = np.array([[np.mean(samples)] for samples in paired.values()])
    everywhere = np.ones(values.shape[1:], dtype=bool)
    return means, find_alike(values, np.ones(means.shape, dtype=bool), everywhere)
