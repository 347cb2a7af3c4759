"""The cells that the paper discusses, and a run's results for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from owtsweep.verdicts import evidence

if TYPE_CHECKING:
    from owtsweep.studies.hub.fidelity.history_errors import HistoryErrors

#: The grid of sections 5.3-5.4: natural periods (s), amplitudes (m), schemes.
PERIODS = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
AMPLITUDES = (0.05, 0.1, 0.2, 0.5, 0.7, 1.0, 2.0, 3.0, 7.0, 10.0)
SCHEMES = ("EKF", "MKF", "HME1", "HME2")


class Cell(NamedTuple):
    """A condition: natural period (s) and amplitude (m)."""

    natural_period: float
    amplitude: float

    def __str__(self) -> str:
        return f"{self.natural_period:g} s, {self.amplitude:g} m"


@dataclass(frozen=True, kw_only=True)
class Evidence(evidence.Evidence):
    """The cases of a run in one window, and its time histories.

    Attributes
    ----------
    history_errors
        Errors of the time histories at 3.8 s; None if the run's schemes or spectrum do not allow
        them.
    """

    history_errors: HistoryErrors | None = None


def cells(
    periods: Sequence[float] = PERIODS, amplitudes: Sequence[float] = AMPLITUDES
) -> list[Cell]:
    """The cells of a grid, sorted by period, then by amplitude."""
    return [Cell(period, amplitude) for period in periods for amplitude in amplitudes]
