"""Schemes whose gains depend on the measurements: they are not linear and have no kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from owtsweep.studies.hub.contract import Estimator, Sensors
from owtsweep.studies.hub.online.coordinates import ZERO

if TYPE_CHECKING:
    from owtsweep.studies.hub.online.estimator import OnlineEstimator


class Stepwise:
    """A scheme of the package under a tuning that makes its gains depend on the measurements.

    Attributes
    ----------
    because
        What makes it so, with its verb, as subject of a message: "its constraints leave".
    """

    linear = False

    def __init__(self, scheme: Any, because: str) -> None:
        self.name, self.sections, self.because = scheme.name, scheme.sections, because
        self._scheme = scheme

    def start(self, sensors: Sensors, tuning: Any) -> Estimator:
        """Return a new estimator that runs step by step."""
        estimator: Estimator = self._scheme.start(sensors, tuning)
        return estimator

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> OnlineEstimator:
        """Return a new compiled estimator that runs step by step; `origin` as in `online_chain`.

        With constraints, each window of the moving horizon estimator is solved without them first.
        If this solution breaks a constraint, the window is solved again, with constraints, by
        CasADi.
        """
        estimator: OnlineEstimator = self._scheme.stream(sensors, tuning, origin)
        return estimator
