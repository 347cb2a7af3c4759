"""A run's evidence on published results: the run's values by scheme, cell and measure.

A cell is a combination of conditions in the run's grid.
"""

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

#: Published values of a condition and those of the run are equal if they agree to this many decimal
#: places.
DIGITS = 9
#: A cell: one number per condition, in the order of the conditions. Labels show `str(cell)`.
Cell = tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The values of a run with which published results are compared.

    Attributes
    ----------
    rows
        The run's rows of results, as `Run.cases` returns them.
    conditions, grid, schemes
        The run's conditions, their numeric values, and its schemes, as planned.
    rivals
        The schemes that the publication compares.
    window
        The part of each record over which errors are averaged, e.g. "full" or "settled".
    criterion
        The measure by which schemes are ranked.
    """

    rows: pd.DataFrame
    conditions: Sequence[Condition]
    grid: Grid
    schemes: tuple[str, ...]
    rivals: tuple[str, ...]
    window: str
    criterion: str = "position"

    @cached_property
    def finished(self) -> pd.DataFrame:
        """The run's rows with the status "ok", for all windows (parts of records)."""
        return self.rows[self.rows["status"] == OK]

    @cached_property
    def values(self) -> pd.DataFrame:
        """The run's values as a table, one row per scheme, cell, measure and replicate.

        A cell holds one number per condition. The values are averages over the part of the record
        that `window` names.
        """
        inside = self.rows[self.rows["window"] == self.window]
        schemes = list(inside["scheme"].unique())
        return Cube.of_rows(inside, schemes, self.conditions, self.grid).to_table()

    @cached_property
    def _by_case(self) -> dict[Any, pd.Series[float]]:
        """The values in `window`: key (scheme, measure, *cell) -> series indexed by replicate.

        The numbers of the cell, one per condition, are rounded to `DIGITS` decimal places.
        """
        names = [condition.name for condition in self.conditions]
        exact = self.values.round(dict.fromkeys(names, DIGITS)).set_index("replicate").sort_index()
        return dict(iter(exact.groupby(["scheme", "measure", *names])["value"]))

    def common(self, keys: Sequence[tuple[str, Cell, str]]) -> list[Array] | None:
        """Return the values of several quantities in the replicates that have all these quantities.

        Parameters
        ----------
        keys
            One key (scheme, cell, measure) per quantity; a cell holds one number per condition.

        Returns
        -------
        list of arrays or None
            One array of shape (replicates,) per key, all in the same order of replicates. None if a
            quantity has no values, or if no replicate has all quantities.
        """
        import pandas as pd

        cases = [
            (scheme, measure, *(round(number, DIGITS) for number in cell))
            for scheme, cell, measure in keys
        ]
        if not all(case in self._by_case for case in cases):
            return None
        found = [self._by_case[case] for case in cases]
        if all(series.index.equals(found[0].index) for series in found):
            return [series.to_numpy() for series in found]  # as a rule; a join is slow
        shared = pd.concat(found, axis=1, join="inner")
        return list(shared.to_numpy().T) if len(shared) else None

    def paired(self, schemes: Sequence[str], cell: Cell) -> dict[str, Array] | None:
        """Return what ranks some schemes in a cell: scheme -> values, shape (replicates,).

        These are the values of the measure `criterion`, as a rule the position MSE. A cell holds
        one number per condition. Only replicates that all of these schemes finished are kept.
        Returns None if there are no such replicates.
        """
        values = self.common([(scheme, cell, self.criterion) for scheme in schemes])
        return None if values is None else dict(zip(schemes, values, strict=True))

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """Return a scheme's values of a measure in a cell; None if the run has no such values.

        The values have the shape (replicates,). A cell holds one number per condition.
        """
        values = self.common([(scheme, cell, measure)])
        return None if values is None else values[0]

    def compare(
        self, label: str, ratio: Sequence[tuple[str, Cell, str]], threshold: float, side: Side
    ) -> Decision | None:
        """Compare the ratio of two means with a threshold.

        The means are taken over the replicates that have a value in both.

        Parameters
        ----------
        label
            Where the ratio is compared, for the reader.
        ratio
            The key (scheme, cell, measure) of the numerator, and the key of the denominator. A cell
            holds one number per condition.
        threshold, side
            The claim: the ratio lies below (or above) the threshold.

        Returns
        -------
        Decision or None
            None if the run lacks the numerator or the denominator, or if no replicate has both.
        """
        values = self.common(ratio)
        return None if values is None else mean_ratio(label, values[0], values[1], threshold, side)

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """Find the best rival of a scheme in a cell: that with the least mean of `criterion`.

        The rivals are the schemes that the publication compares. Two schemes coincide if they agree
        in every replicate. A rival that coincides with `scheme` is left out. If the best rivals
        coincide, the last of them is taken.

        Returns
        -------
        tuple or None
            Name of the rival, the values of `scheme`, and those of the rival, each of the shape
            (replicates,). None if the cell lacks one of the rivals, or if every rival
            coincides with `scheme`.
        """
        paired = self.paired(self.rivals, cell)
        if paired is None:
            return None
        best = find_best(paired, other_than=scheme)
        return None if best is None else (best, paired[scheme], paired[best])


def find_best(paired: Mapping[str, Array], *, other_than: str = "") -> str | None:
    """Return the name of the scheme with the least mean.

    Two schemes coincide if they agree in every replicate. If the best schemes coincide, the last of
    them is named. Returns None if `other_than` leaves no scheme.

    Parameters
    ----------
    paired
        Scheme -> its values, shape (replicates,), in the same order of replicates for all schemes.
    other_than
        A scheme to leave out, together with all schemes that coincide with it; "" for none.
    """
    names, values = list(paired), np.array(list(paired.values()))[:, np.newaxis]
    means = np.array([[np.mean(samples)] for samples in paired.values()])
    everyone = np.ones(means.shape, dtype=bool)
    alike = find_alike(values, everyone, np.ones(values.shape[1:], dtype=bool))
    chosen = ~alike[names.index(other_than)] if other_than else everyone
    return names[int(find_least(means, chosen, alike)[0][0])] if chosen.any() else None
