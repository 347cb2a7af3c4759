"""Runs SKF or SKFA step by step, as on board: a filter along x, and one along y."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.studies.hub.contract import ZERO
from owtsweep.studies.hub.online.coordinates import (
    LocatedEstimator,
    check_grid,
    check_origin,
    check_samples,
)
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.spectral_filter import AxisFilter


class SpectralEstimator(LocatedEstimator):
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
        super().__init__(sensors, point)
        self._filters, self._rest, self._step = filters, np.asarray(point), 0

    def _run(self, specific_force: Array, positions: Array) -> tuple[Array, Array, Array, Array]:
        force = np.asarray(specific_force, dtype=float)
        fixes = np.asarray(positions, dtype=float)
        at = self._step + check_samples(force, fixes, self._step)
        check_grid("SKF", at, self._sensors.fix_interval)
        force, fixes = force @ self._sensors.rotation.T, fixes - self._rest
        steps = len(force)
        state, innovation = np.empty((steps, 4)), np.empty((steps, 2))
        covariance, of_innovation = np.zeros((steps, 4, 4)), np.zeros((steps, 2, 2))
        for axis, filter in enumerate(self._filters):
            part = filter.take(force[:, axis].copy(), fixes[:, axis].copy())
            state[:, axis::2], covariance[:, axis::2, axis::2] = part.state, part.covariance
            innovation[:, axis], of_innovation[:, axis, axis] = part.innovation, part.variance
        self._step += steps
        state[:, :2] += self._rest
        return state, covariance, innovation, of_innovation
