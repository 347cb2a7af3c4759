"""The cells (natural period, amplitude) of Ren et al. (2019), and a run's results in the cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from owtsweep.errors import InputError
from owtsweep.results.boundary import find_boundary, find_boundary_ratio
from owtsweep.studies.hub.conditions import BOUNDARY, CONDITIONS
from owtsweep.verdicts.evidence import DIGITS, Evidence
from owtsweep.verdicts.inference import Estimate

if TYPE_CHECKING:
    from owtsweep.studies.hub.fidelity.history_errors import HistoryErrors

#: The grid of the paper's sections 5.3 and 5.4: natural periods (s), amplitudes (m), schemes.
PERIODS = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
AMPLITUDES = (0.05, 0.1, 0.2, 0.5, 0.7, 1.0, 2.0, 3.0, 7.0, 10.0)
SCHEMES = ("EKF", "MKF", "HME1", "HME2")


class Cell(NamedTuple):
    """A cell, which is a point of the grid: natural period (s) and amplitude (m)."""

    natural_period: float
    amplitude: float

    def __str__(self) -> str:
        return f"{self.natural_period:g} s, {self.amplitude:g} m"


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """Return all pairs of these natural periods (s) and amplitudes (m), period by period.

    The default is the grid of Ren et al. (2019).
    """
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]


@dataclass(frozen=True)
class Boundary(Estimate):
    """The boundary: the amplitude (m) below which HME2 has the smaller MSE, HME1 above.

    The 95 % interval is a bootstrap over the replicates. If there is a boundary, `wins` is "". If
    there is no boundary, the amplitude is NaN, and `wins` names the scheme that is better at every
    amplitude. In this case `wins` is "neither" if the two MSEs cross twice, or if HME1 is better
    below and HME2 above.
    """

    wins: str = ""


@dataclass(frozen=True, kw_only=True)
class HubEvidence(Evidence):
    """The results of a hub run, with which the published results are compared.

    Attributes
    ----------
    history_errors
        Errors of the time histories at the natural period 3.8 s; None if they could not be
        simulated with the run's schemes or spectrum.
    """

    history_errors: HistoryErrors | None = None

    @cached_property
    def along_x(self) -> HubEvidence:
        """The same results, with schemes ranked by the MSE of x alone instead of x + y."""
        return replace(self, criterion="x")

    @cached_property
    def boundaries(self) -> dict[float, Boundary]:
        """Natural period (s) -> amplitude at which HME1 and HME2 have equal MSE (`criterion`).

        The dict is empty if the run lacks one of the two schemes, or was not run with
        evaluation=superposed.
        """
        try:
            table = find_boundary(self.rows, CONDITIONS, BOUNDARY, self.criterion, self.window)
        except InputError:  # a scheme is missing, or cases run directly: they have no products
            return {}
        boundaries = {}
        rows: Any = table.itertuples(index=False)
        for row in rows:
            label = f"boundary at {row.natural_period:g} s"
            if row.wins == "neither":
                label += " (none: the means cross twice, or the other way round)"
            elif row.wins:
                label += f" (none: {row.wins} is better at every amplitude)"
            boundaries[round(row.natural_period, DIGITS)] = Boundary(
                label, row.boundary, row.ci_low, row.ci_high, row.wins
            )
        return boundaries

    @cached_property
    def growth(self) -> Estimate | None:
        """The boundary at a natural period of 8 s, divided by the boundary at 4 s.

        The boundary is the amplitude at which HME1 and HME2 have equal MSE. The ratio is
        NaN if one of the two boundaries does not exist. The ratio is None if the run lacks one of
        these periods or schemes, or was not run with evaluation=superposed.
        """
        periods = (8.0,), (4.0,)
        try:
            ratio = find_boundary_ratio(
                self.rows, CONDITIONS, periods, BOUNDARY, self.criterion, self.window
            )
        except InputError:
            return None
        return Estimate("boundary at 8 s over that at 4 s", *ratio)
