"""Runs SKF or SKFA step by step, as on board: a filter along x, and one along y."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.evaluation.loop import RecordEstimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.contract import ZERO
from owtsweep.studies.hub.online.coordinates import check_origin, check_sample, check_samples
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.spectral_filter import AxisFilter


class SpectralEstimator(RecordEstimator):
    """A running SKF or SKFA: `update` takes one IMU sample, `run_record` takes many samples.

    Any position fix may be missing, but fixes come only at multiples of the fix interval, because
    the filter copies the positions that the fixes will report.

    filters: the filters along x and y, before their first step.
    origin: the position of the hub at rest, x and y in m, in the coordinates of the fixes. The
        motion of known spectrum is about this point, so one fix cannot tell it.
    Raises InputError if the origin is not two finite numbers.
    """

    def __init__(
        self,
        filters: tuple[AxisFilter, AxisFilter],
        sensors: Sensors,
        origin: ArrayLike | None = ZERO,
    ) -> None:
        point = check_origin(origin)
        require(
            point is not None,
            "origin: this scheme must know where the hub is at rest, and one fix does not show "
            "it; give x and y in m, e.g. origin=(0, 0)",
        )
        self._origin: Array = np.asarray(point)
        self._sensors, self._filters = sensors, filters
        self._step = 0
        self._force, self._fix = np.empty((1, 2)), np.empty((1, 2))

    @property
    def origin(self) -> Array:
        """The position of the hub at rest, m, shape (2,)."""
        return self._origin.copy()

    @property
    def step(self) -> float:
        return self._sensors.step

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample and perhaps a position fix; return the estimate of the present state.

        Arguments and result are as of `OnlineEstimator.update`. Raises ValueError if a sample is
        not two finite numbers, or a fix comes at a step that is no multiple of the fix interval.
        The estimator is left unchanged.
        """
        check_sample(specific_force, position)
        self._force[0] = specific_force
        self._fix[0] = np.nan if position is None else position
        state, covariance, residual, variance = self._run(self._force, self._fix)
        innovation = None
        if residual[0, 0] == residual[0, 0]:  # not NaN
            innovation = Innovation(residual[0], variance[0])
        return Estimate(state[0, :2], state[0, 2:], covariance[0], innovation)

    def run_record(self, specific_force: Array, positions: Array) -> Trajectory:
        """Take many IMU samples, shape (steps, 2), at once, as if `update` took each in turn.

        Both components of a position are NaN at steps without a fix. Raises ValueError as `update`,
        or if the shapes are wrong. The estimator is left unchanged.
        """
        return Trajectory(*self._run(specific_force, positions))

    def _run(self, specific_force: Array, positions: Array) -> tuple[Array, Array, Array, Array]:
        force = np.asarray(specific_force, dtype=float)
        fixes = np.asarray(positions, dtype=float)
        self._check(force, fixes)
        force, fixes = force @ self._sensors.rotation.T, fixes - self._origin
        steps = len(force)
        state, innovation = np.empty((steps, 4)), np.empty((steps, 2))
        covariance, of_innovation = np.zeros((steps, 4, 4)), np.zeros((steps, 2, 2))
        for axis, filter in enumerate(self._filters):
            part = filter.take(force[:, axis].copy(), fixes[:, axis].copy())
            state[:, axis::2], covariance[:, axis::2, axis::2] = part.state, part.covariance
            innovation[:, axis], of_innovation[:, axis, axis] = part.innovation, part.variance
        self._step += steps
        state[:, :2] += self._origin
        return state, covariance, innovation, of_innovation

    def _check(self, force: Array, fixes: Array) -> None:
        at = self._step + check_samples(force, fixes, self._step)
        interval = self._sensors.fix_interval
        off = at[at % interval != 0]
        if len(off):
            raise ValueError(
                f"position: a fix came at step {off[0]}, but SKF takes fixes only at multiples of "
                f"{interval} IMU steps; give the fix at the next multiple, or leave the fix out"
            )
