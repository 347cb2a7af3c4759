"""A filter of one axis of SKF that takes its gains from a schedule, as long as all fixes arrive.

When a fix is missing, the covariance of that step is computed from the filter's start, and from
then on at each step. The result is the Kalman filter's in either case.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.late_gains import LateRows
from owtsweep.studies.hub.axis_filters import AxisEstimates
from owtsweep.studies.hub.spectral_axis import SpectralAxis
from owtsweep.studies.hub.tracked_models import find_gains


class ScheduledFilter:
    """A running filter of one axis; see `axis_filters.AxisFilter`.

    Parameters
    ----------
    axis
        The model, with a state of N numbers.
    bias
        Estimate of the IMU's bias one step before the first, m/s^2.
    """

    def __init__(self, axis: SpectralAxis, bias: float) -> None:
        self._axis, self._gains, self._step = axis, find_gains(axis), 0
        self._state = np.zeros(len(axis.first))
        self._state[len(axis.model.Q)] = bias
        self._covariance: Array | None = None  # None while the gains are those of the schedule

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""
        return float(self._state[len(self._axis.model.Q)])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the measurements of the next steps, shape (steps,) each; return the estimates.

        `force` is the specific force, m/s^2, and `fixes` are position fixes, m; NaN at steps
        without a fix. Fixes come only at steps that are multiples of the fix interval.
        """
        from owtsweep.studies.hub.kernels.spectral_online import take_samples
        from owtsweep.studies.hub.kernels.spectral_single import follow

        steps, done = len(force), 0
        result = AxisEstimates.make_empty(steps)
        model, outputs = self._axis.model, self._axis.outputs
        if self._covariance is None:
            samples, gains = (force, fixes), tuple(self._gains.find(self._step + steps))
            done = follow(self._step, samples, model, outputs, gains, self._state, tuple(result))
            if done < steps:
                self._covariance = self._compute_covariance(self._step + done)
        if done < steps:
            register = self._state, self._covariance, np.empty(len(self._state))
            rest = tuple(array[done:] for array in result)
            samples = force[done:], fixes[done:]
            take_samples(self._step + done, samples, model, outputs, register, rest)
        self._step += steps
        return result

    def _compute_covariance(self, steps: int) -> Array:
        """Compute the covariance of the state after some steps, a multiple of the fix interval."""
        from owtsweep.estimation.late import late_recursion

        P, N, M = self._axis.first.copy(), len(self._state), self._axis.model.interval
        shapes = (steps, N), (steps // M, N), (steps // M,), (steps, 2, 2)
        unused = LateRows(*(np.empty(shape) for shape in shapes))
        never = np.full((N, N), np.nan)
        late_recursion(0, steps, self._axis.model, P, self._axis.outputs, 0.0, never, unused)
        return P
