"""What a run has to say about the paper: the values of its cells, looked up by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.base import OK
from owtsweep.studies.hub.aggregate import COINCIDENCE, expand

if TYPE_CHECKING:
    import pandas as pd

#: The grid of sections 5.3-5.4: natural periods (s), amplitudes (m), schemes.
PERIODS = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
AMPLITUDES = (0.05, 0.1, 0.2, 0.5, 0.7, 1.0, 2.0, 3.0, 7.0, 10.0)
SCHEMES = ("EKF", "MKF", "HME1", "HME2")
#: Digits to which a condition of the paper and one of the run are the same.
DIGITS = 9


class Cell(NamedTuple):
    """A condition: natural period (s) and amplitude (m)."""

    natural_period: float
    amplitude: float

    def __str__(self) -> str:
        return f"{self.natural_period:g} s, {self.amplitude:g} m"


@dataclass(frozen=True)
class Evidence:
    """The cases of a run in one window.

    Attributes
    ----------
    rows
        The run's cases, as `Run.cases` returns them.
    schemes, periods, amplitudes
        What the run was planned for.
    window
        "full" or "settled".
    histories
        Measures of single time histories at 3.8 s: name -> (replicates,), see
        `fidelity.histories`; empty where they were not made.
    """

    rows: pd.DataFrame
    schemes: tuple[str, ...]
    periods: tuple[float, ...]
    amplitudes: tuple[float, ...]
    window: str
    histories: Mapping[str, Array]

    @cached_property
    def finished(self) -> pd.DataFrame:
        """The rows of finished cases, both windows."""
        return self.rows[self.rows["status"] == OK]

    @cached_property
    def values(self) -> pd.DataFrame:
        """One value per scheme, cell, measure and replicate, in the chosen window."""
        inside = self.rows[self.rows["window"] == self.window]
        return expand(inside, list(self.amplitudes))

    @cached_property
    def _by_case(self) -> dict[tuple[str, str, float, float], pd.Series[float]]:
        keys = ["scheme", "measure", "natural_period", "amplitude"]
        return {
            (scheme, measure, round(period, DIGITS), round(amplitude, DIGITS)): group.set_index(
                "replicate"
            )["value"].sort_index()
            for (scheme, measure, period, amplitude), group in self.values.groupby(keys)
        }

    def has(self, schemes: Iterable[str], cell: Cell, measure: str = "position") -> bool:
        """Whether every one of the schemes has a value in the cell."""
        return self.paired(schemes, cell, measure) is not None

    def paired(
        self, schemes: Iterable[str], cell: Cell, measure: str = "position"
    ) -> dict[str, Array] | None:
        """Scheme -> (replicates,) over the replicates that all of them finished.

        Returns None if a scheme has nothing there or no replicate is common to all.
        """
        found = {
            scheme: self._by_case.get(
                (scheme, measure, round(cell.natural_period, DIGITS), round(cell.amplitude, DIGITS))
            )
            for scheme in schemes
        }
        present = {scheme: series for scheme, series in found.items() if series is not None}
        if len(present) < len(found) or not present:
            return None
        common = None
        for series in present.values():
            common = series.index if common is None else common.intersection(series.index)
        if common is None or len(common) == 0:
            return None
        return {scheme: series[common].to_numpy() for scheme, series in present.items()}

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """(replicates,) of one scheme, or None."""
        found = self.paired([scheme], cell, measure)
        return None if found is None else found[scheme]

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """The best by mean position MSE of the paper's other schemes, beside `scheme`.

        As in the map, a scheme that coincides with `scheme` is no other one.

        Returns
        -------
        (name, (replicates,) of `scheme`, (replicates,) of the other), or None where one of the
        four schemes is missing or all of them coincide.
        """
        found = self.paired(SCHEMES, cell)
        if found is None:
            return None
        own = found.pop(scheme)
        others = {name: a for name, a in found.items() if not coincide(own, a)}
        if not others:
            return None
        best = min(others, key=lambda name: float(np.mean(others[name])))
        return best, own, others[best]


def coincide(a: Array, b: Array) -> bool:
    """Whether two schemes agree up to rounding in every replicate."""
    return bool(np.all(np.abs(a - b) <= COINCIDENCE * np.maximum(np.abs(a), np.abs(b))))


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """The cells of a grid, by period, then amplitude."""
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]
