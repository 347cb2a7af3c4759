"""The cells (natural period, amplitude) that the paper discusses, and a run's results there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
    """A cell of the grid: natural period (s) and amplitude (m)."""

    natural_period: float
    amplitude: float

    def __str__(self) -> str:
        return f"{self.natural_period:g} s, {self.amplitude:g} m"


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """Return all cells of these natural periods (s) and amplitudes (m), period by period."""
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]


@dataclass(frozen=True)
class Boundary(Estimate):
    """The amplitude (m) below which HME2 has the smaller position MSE, and HME1 above.

    The 95 % interval is a bootstrap over the replicates. If there is a boundary, `wins` is "". If
    there is none, the amplitude is NaN and `wins` names the scheme that is better at every
    amplitude. It is "neither" if the means cross twice or the other way round.
    """

    wins: str = ""


@dataclass(frozen=True, kw_only=True)
class HubEvidence(Evidence):
    """The values of a hub run that published results are compared with.

    Attributes
    ----------
    history_errors
        Errors of the time histories at the natural period 3.8 s; None if they could not be
        simulated with the run's schemes or spectrum.
    """

    history_errors: HistoryErrors | None = None

    @cached_property
    def boundaries(self) -> dict[float, Boundary]:
        """The HME1/HME2 boundary by natural period (s), for the periods that have both schemes.

        Empty if the run lacks a scheme, or was not run with evaluation=superposed.
        """
        try:
            table = find_boundary(self.rows, CONDITIONS, BOUNDARY, "position", self.window)
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
        """The boundary at 8 s divided by the boundary at 4 s; None if the run lacks a period.

        NaN if one of the two boundaries does not exist.
        """
        periods = (8.0,), (4.0,)
        try:
            ratio = find_boundary_ratio(
                self.rows, CONDITIONS, periods, BOUNDARY, "position", self.window
            )
        except InputError:
            return None
        return Estimate("boundary at 8 s over that at 4 s", *ratio)
