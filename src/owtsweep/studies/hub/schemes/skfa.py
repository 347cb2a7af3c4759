"""SKFA: SKF that is told nothing, and tracks the spectrum and the variance of the motion itself.

It is for steady seas, fixes without outliers or red noise, and an IMU whose tilt is known: an
outlier or a slow error of the fixes is taken for motion (docs/better.md, "Where SKFA is not the
answer"). See `motion.tracking` for how a spectrum is chosen, and `tracking_filter` for what
follows from it.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from numpy.typing import ArrayLike

from owtsweep.studies.hub.axis_filters import KalmanAxisFilter
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.online.coordinates import ZERO
from owtsweep.studies.hub.online.spectral import SpectralEstimator
from owtsweep.studies.hub.scheduled_filter import ScheduledFilter
from owtsweep.studies.hub.tracking_filter import TrackingFilter


class AdaptiveSpectralScheme:
    """The scheme SKFA. Its gains depend on the measurements, so it is not linear."""

    name = "SKFA"
    linear = False
    sections = ("skf", "band")

    def start(self, sensors: Sensors, tuning: Any) -> SpectralEstimator:
        """Return a new estimator that runs step by step."""
        return self._start(sensors, tuning, KalmanAxisFilter, ZERO)

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> SpectralEstimator:
        """Return a new compiled estimator that runs step by step; `origin` is the hub at rest, m.

        Raises
        ------
        InputError
            If the origin is not stated.
        """
        return self._start(sensors, tuning, ScheduledFilter, origin)

    def _start(
        self, sensors: Sensors, tuning: Any, filter: Any, origin: ArrayLike | None
    ) -> SpectralEstimator:
        band = (float(tuning.band[0]), float(tuning.band[1]))
        make = partial(TrackingFilter, tuning.skf, sensors, band, filter)
        return SpectralEstimator((make(), make()), sensors, origin)


SCHEME = AdaptiveSpectralScheme()
