"""SKF: a Kalman filter that knows the spectrum of the motion and its variance.

The schemes of Ren et al. (2019) follow any motion. SKF takes the motion for what a linear system,
the shaping filter, makes of white noise, so that it has the given spectrum. Each axis has a filter
of its own, which measures IMU samples and position fixes. A fix is applied to a copy of the
position that it reports (see `estimation.late_model`), so there is no smoother and no predictor.

The spectrum and the variance are not data of the sensors. A sweep tells SKF those of each cell;
elsewhere the keys skf.natural_period and skf.amplitude give them.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from owtsweep.errors import require
from owtsweep.studies.hub.axis_filters import CompiledAxisFilter, KalmanAxisFilter
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.known_motion import KnownMotion, find_known_motion
from owtsweep.studies.hub.online.coordinates import ZERO
from owtsweep.studies.hub.online.spectral import SpectralEstimator
from owtsweep.studies.hub.spectral_model import make_axes, tune_axes
from owtsweep.studies.hub.spectral_run import SpectralKernel
from owtsweep.vectors import choose


class SpectralScheme:
    """The scheme SKF, which must be told the motion.

    Attributes
    ----------
    known
        What SKF was told of the motion; None before.
    """

    name = "SKF"
    #: Estimates are linear in the measurements, but the gains are those of one amplitude (`told`).
    linear = True
    sections = ("skf", "spectrum", "normalise", "band", "wave_direction")

    def __init__(self, known: KnownMotion | None = None) -> None:
        self.known = known

    def told(self, tuning: Any, natural_period: float, amplitude: float) -> SpectralScheme:
        """Return the scheme with the knowledge of a motion of a natural period and an amplitude.

        `tuning` is the study's configuration. Its keys skf.natural_period and skf.amplitude, if
        given, replace the arguments (s and m).
        """
        own = tuning.skf
        period = natural_period if own.natural_period is None else own.natural_period
        size = amplitude if own.amplitude is None else own.amplitude
        return SpectralScheme(find_known_motion(tuning, period, size))

    def start(self, sensors: Sensors, tuning: Any) -> SpectralEstimator:
        """Return a new estimator that runs step by step.

        Raises
        ------
        InputError
            If neither `told` nor the configuration has said what the motion is.
        """
        x, y = make_axes(self._recall(tuning), tuning.skf, sensors)
        return SpectralEstimator((KalmanAxisFilter(x), KalmanAxisFilter(y)), sensors)

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> SpectralEstimator:
        """Return a new compiled estimator that runs step by step; `origin` is the hub at rest, m.

        Raises
        ------
        InputError
            If nothing has said what the motion is, or the origin is not stated.
        """
        x, y = make_axes(self._recall(tuning), tuning.skf, sensors)
        return SpectralEstimator((CompiledAxisFilter(x), CompiledAxisFilter(y)), sensors, origin)

    def own_kernel(self, sensors: Sensors, tuning: Any, steps: int) -> SpectralKernel:
        """Return the scheme in its form for the batch engine, for records of `steps` IMU steps.

        Raises
        ------
        InputError
            If nothing has said what the motion is.
        """
        choose(tuning.compute.vectors)
        return SpectralKernel(tune_axes(self._recall(tuning), tuning.skf, sensors, steps))

    def _recall(self, tuning: Any) -> KnownMotion:
        """Return what is known of the motion: what was told, or what the configuration gives."""
        if self.known is not None:
            return self.known
        own = tuning.skf
        require(
            own.natural_period is not None and own.amplitude is not None,
            "skf.natural_period, skf.amplitude: SKF must be told the motion; give the period of "
            "its peak and its amplitude, e.g. skf.natural_period=4 skf.amplitude=0.5",
        )
        return find_known_motion(tuning, own.natural_period, own.amplitude)


SCHEME = SpectralScheme()
