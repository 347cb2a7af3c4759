"""A run's evidence on published results: the values of its cells, looked up by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.statistics.contest import find_alike, find_least
from owtsweep.verdicts.inference import Decision, Side, mean_ratio

if TYPE_CHECKING:
    import pandas as pd

#: A published condition and one of the run are the same if they agree to this many decimal places.
DIGITS = 9
#: A cell: one number per condition, in the order of the conditions. `str(cell)` names it.
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
    def _by_case(self) -> dict[Any, pd.Series[float]]:
        """(scheme, measure, *cell) -> values in the window, by replicate."""
        names = [condition.name for condition in self.conditions]
        exact = self.values.round(dict.fromkeys(names, DIGITS)).set_index("replicate").sort_index()
        return dict(iter(exact.groupby(["scheme", "measure", *names])["value"]))

    def common(self, keys: Sequence[tuple[str, Cell, str]]) -> list[Array] | None:
        """(replicates,) for each (scheme, cell, measure), over the replicates that all share.

        Returns None if one has no values or if no replicate is common to all.
        """
        import pandas as pd

        cases = [
            (scheme, measure, *(round(number, DIGITS) for number in cell))
            for scheme, cell, measure in keys
        ]
        if not all(case in self._by_case for case in cases):
            return None
        shared = pd.concat([self._by_case[case] for case in cases], axis=1, join="inner")
        return list(shared.to_numpy().T) if len(shared) else None

    def paired(self, schemes: Sequence[str], cell: Cell) -> dict[str, Array] | None:
        """Scheme -> (replicates,) position MSE in a cell, over the replicates that all finished."""
        values = self.common([(scheme, cell, "position") for scheme in schemes])
        return None if values is None else dict(zip(schemes, values, strict=True))

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """(replicates,) values of one scheme, or None."""
        values = self.common([(scheme, cell, measure)])
        return None if values is None else values[0]

    def compare(
        self, label: str, ratio: Sequence[tuple[str, Cell, str]], threshold: float, side: Side
    ) -> Decision | None:
        """Compare the ratio of two means with a threshold, over the replicates that both share.

        `ratio` holds (scheme, cell, measure) of both means. Returns None if the run lacks one.
        """
        values = self.common(ratio)
        return None if values is None else mean_ratio(label, values[0], values[1], threshold, side)

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
        best = find_best(paired, other_than=scheme)
        return None if best is None else (best, paired[scheme], paired[best])


def find_best(paired: Mapping[str, Array], *, other_than: str = "") -> str | None:
    """The scheme of least mean; of coinciding schemes the last, as in the map.

    A scheme that coincides with `other_than` is left out; None if no other one is left.
    """
    names, values = list(paired), np.array(list(paired.values()))[:, np.newaxis]
    means = np.array([[np.mean(samples)] for samples in paired.values()])
    everyone = np.ones(means.shape, dtype=bool)
    alike = find_alike(values, everyone, np.ones(values.shape[1:], dtype=bool))
    chosen = ~alike[names.index(other_than)] if other_than else everyone
    return names[int(find_least(means, chosen, alike)[0][0])] if chosen.any() else None
