"""What a run has to say about the paper: the values of its cells, looked up by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.expand import expand
from owtsweep.results.status import OK
from owtsweep.statistics.contest import find_alike, find_least
from owtsweep.studies.hub.conditions import CONDITIONS

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
        return expand(inside, CONDITIONS, {"amplitude": self.amplitudes})

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
        cases = []
        for scheme, cell, measure in keys:
            period, amplitude = (round(number, DIGITS) for number in cell)
            case = self._by_case.get((scheme, measure, period, amplitude))
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
        """(replicates,) of one scheme, or None."""
        values = self.common([(scheme, cell, measure)])
        return None if values is None else values[0]

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """The best by mean position MSE of the paper's other schemes, beside `scheme`.

        As in the map, a scheme that coincides with `scheme` is no other one, and coinciding
        others go by the last name.

        Returns
        -------
        (name, (replicates,) of `scheme`, (replicates,) of the other), or None where one of the
        four schemes is missing or all of them coincide.
        """
        paired = self.paired(SCHEMES, cell)
        if paired is None:
            return None
        means, alike = _one_cell(paired)
        others = ~alike[SCHEMES.index(scheme)]
        if not others.any():
            return None
        best = SCHEMES[int(find_least(means, others, alike)[0][0])]
        return best, paired[scheme], paired[best]


def least(paired: Mapping[str, Array]) -> str:
    """The scheme of least mean; of coinciding ones the last, as in the map."""
    means, alike = _one_cell(paired)
    return list(paired)[int(find_least(means, np.ones(means.shape, dtype=bool), alike)[0][0])]


def _one_cell(paired: Mapping[str, Array]) -> tuple[Array, NDArray[np.bool_]]:
    """Means (schemes, 1) and who coincides with whom (schemes, schemes, 1)."""
    values = np.array(list(paired.values()))[:, np.newaxis]
    means = np.array([[np.mean(samples)] for samples in paired.values()])
    everywhere = np.ones(values.shape[1:], dtype=bool)
    return means, find_alike(values, np.ones(means.shape, dtype=bool), everywhere)


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """The cells of a grid, by period, then amplitude."""
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]
