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

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.estimation.late_model import copying, transition
from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.known_motion import KnownMotion, find_known_motion
from owtsweep.studies.hub.online.coordinates import ZERO
from owtsweep.studies.hub.online.spectral import OnlineSpectral
from owtsweep.studies.hub.spectral_axis import SpectralAxis
from owtsweep.studies.hub.spectral_model import make_axes, tune_axes
from owtsweep.studies.hub.spectral_run import SpectralKernel
from owtsweep.vectors import choose


class AxisEstimator:
    """The Kalman filter of SKF along one axis, by filterpy."""

    def __init__(self, axis: SpectralAxis) -> None:
        from filterpy.kalman import KalmanFilter

        model = axis.model
        n, N = len(model.Q), len(axis.first)
        self.model, self.outputs = model, np.zeros((2, N))
        self.outputs[:, :n] = axis.outputs
        self.kf = KalmanFilter(dim_x=N, dim_z=1)
        self.kf.P = axis.first.copy()
        self.kf.Q = np.zeros((N, N))
        self.kf.Q[:n, :n] = model.Q
        self.kf.Q[n, n] = model.walk
        self.predict, self.copy = transition(model), copying(model)
        self.force_row = np.zeros((1, N))
        self.force_row[0, :n], self.force_row[0, n] = model.fast, 1.0
        self.fix_row = np.zeros((1, N))
        if model.copies:
            self.fix_row[0, -1] = 1.0
        else:
            self.fix_row[0, :n] = model.slow
        self.step = 0

    def update(self, force: float, fix: float | None) -> tuple[Array, Array, Array | None]:
        """Run one step with a specific force (m/s^2) and a fix (m) or None, both along the axis.

        Returns
        -------
        tuple of array
            Position and velocity (2,), their covariance (2, 2), and of the fix the innovation and
            its variance, shape (2,), or None.
        """
        kf, model, innovation = self.kf, self.model, None
        kf.predict(F=self.predict)
        kf.update(force, R=model.r_fast, H=self.force_row)
        if fix is not None:
            kf.update(fix, R=model.r_slow, H=self.fix_row)
            innovation = np.array([kf.y[0, 0], kf.S[0, 0]])
        C = self.outputs
        result = C @ kf.x[:, 0], C @ kf.P @ C.T, innovation
        if model.copies and (self.step + model.delay) % model.interval == 0:
            kf.x, kf.P = self.copy @ kf.x, self.copy @ kf.P @ self.copy.T
        self.step += 1
        return result


class SpectralEstimator:
    """SKF as an estimator that runs step by step: a filter along x, and one along y."""

    def __init__(self, axes: tuple[SpectralAxis, SpectralAxis], rotation: Array) -> None:
        self.axes, self.rotation = [AxisEstimator(axis) for axis in axes], rotation

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the filtered state.

        `specific_force` is in the IMU's frame, m/s^2, shape (2,); `position` is in NED, m, (2,).
        """
        force = self.rotation @ specific_force
        fixes = [None, None] if position is None else position
        parts = [
            axis.update(float(one), None if fix is None else float(fix))
            for axis, one, fix in zip(self.axes, force, fixes, strict=True)
        ]
        state = np.stack([part[0] for part in parts], axis=1)
        covariance = np.zeros((4, 4))
        for axis, part in enumerate(parts):
            covariance[axis::2, axis::2] = part[1]
        innovation = None
        if position is not None:
            told = np.array([part[2] for part in parts])
            innovation = Innovation(told[:, 0], np.diag(told[:, 1]))
        return Estimate(state[0], state[1], covariance, innovation)


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
        axes = make_axes(self._recall(tuning), tuning.skf, sensors)
        return SpectralEstimator(axes, sensors.rotation)

    def stream(
        self, sensors: Sensors, tuning: Any, origin: ArrayLike | None = ZERO
    ) -> OnlineSpectral:
        """Return a new compiled estimator that runs step by step; `origin` is the hub at rest, m.

        Raises
        ------
        InputError
            If nothing has said what the motion is, or the origin is not stated.
        """
        axes = make_axes(self._recall(tuning), tuning.skf, sensors)
        return OnlineSpectral(axes, sensors, origin)

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
