"""What a run has to say about the paper: the values of its cells, looked up by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.results.aggregate import expand
from owtsweep.statistics.contest import agree
from owtsweep.sweep.study import OK

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.hub.fidelity.histories import Histories

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
        Time histories at 3.8 s; None where the run's schemes or spectrum do not allow them.
    """

    rows: pd.DataFrame
    schemes: tuple[str, ...]
    periods: tuple[float, ...]
    amplitudes: tuple[float, ...]
    window: str
    histories: Histories | None = None

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
    def _by_case(self) -> dict[tuple[str, str, float, float], tuple[Array, Array]]:
        """(scheme, measure, period, amplitude) -> replicates in order, and their values."""
        values = self.values.sort_values("replicate", kind="stable")
        replicate, value = values["replicate"].to_numpy(), values["value"].to_numpy()
        exact = values.round({"natural_period": DIGITS, "amplitude": DIGITS})
        groups: dict[Any, Any] = exact.groupby(
            ["scheme", "measure", "natural_period", "amplitude"]
        ).indices
        return {case: (replicate[index], value[index]) for case, index in groups.items()}

    def common(self, keys: Sequence[tuple[str, Cell, str]]) -> list[Array] | None:
        """(replicates,) for each (scheme, cell, measure), over the replicates that all have.

        Returns None if one has nothing or no replicate is common to all.
        """
        found = []
        for scheme, cell, measure in keys:
            period, amplitude = (round(number, DIGITS) for number in cell)
            case = self._by_case.get((scheme, measure, period, amplitude))
            if case is None:
                return None
            found.append(case)
        shared = found[0][0]
        for replicates, _ in found[1:]:
            shared = np.intersect1d(shared, replicates, assume_unique=True)
        if not len(shared):
            return None
        return [values[np.isin(replicates, shared)] for replicates, values in found]

    def paired(
        self, schemes: Sequence[str], cell: Cell, measure: str = "position"
    ) -> dict[str, Array] | None:
        """Scheme -> (replicates,) in one cell, over the replicates that all of them finished."""
        found = self.common([(scheme, cell, measure) for scheme in schemes])
        return None if found is None else dict(zip(schemes, found, strict=True))

    def samples(self, scheme: str, cell: Cell, measure: str) -> Array | None:
        """(replicates,) of one scheme, or None."""
        found = self.common([(scheme, cell, measure)])
        return None if found is None else found[0]

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """The best by mean position MSE of the paper's other schemes, beside `scheme`.

        As in the map, a scheme that coincides with `scheme` is no other one, and coinciding
        others go by the last name.

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
        best = least(others)
        return best, own, others[best]


def coincide(a: Array, b: Array) -> bool:
    """Whether two schemes agree up to rounding in every replicate."""
    return bool(np.all(agree(a, b)))


def least(found: Mapping[str, Array]) -> str:
    """The scheme of least mean; of coinciding ones the last, as in the map."""
    best = min(found, key=lambda name: float(np.mean(found[name])))
    return [name for name, values in found.items() if coincide(values, found[best])][-1]


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """The cells of a grid, by period, then amplitude."""
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]
