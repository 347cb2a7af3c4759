"""Filters of one axis of SKF, step by step: the interface, by filterpy, compiled, scheduled."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.late_gains import LateRows, copying, transition
from owtsweep.studies.hub.spectral_axis import SpectralAxis
from owtsweep.studies.hub.tracked_models import find_gains


class AxisEstimates(NamedTuple):
    """What a filter makes of the measurements of some steps along one axis.

    Attributes
    ----------
    state
        Position (m) and velocity (m/s), shape (steps, 2).
    covariance
        Covariance of the error of `state`, shape (steps, 2, 2).
    innovation, variance
        Innovation of the fix, m, and its variance, m^2, shape (steps,) each; NaN without a fix.
    """

    state: Array
    covariance: Array
    innovation: Array
    variance: Array

    @classmethod
    def make_empty(cls, steps: int) -> AxisEstimates:
        """Return the arrays for the estimates of some steps, to be filled."""
        return cls(np.empty((steps, 2)), np.empty((steps, 2, 2)), *np.full((2, steps), np.nan))


class AxisFilter(Protocol):
    """A running filter of one axis; its first step is a step at which a fix is due."""

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""
        ...

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the measurements of the next steps; return the estimates of these steps.

        `force` is the specific force, m/s^2, and `fixes` are position fixes, m, shape (steps,)
        each; NaN at steps without a fix. Fixes come only at multiples of the fix interval.
        """
        ...


class KalmanAxisFilter:
    """The Kalman filter of one axis, by filterpy; see `AxisFilter`.

    Parameters
    ----------
    axis
        The model.
    bias
        Estimate of the IMU's bias one step before the first, m/s^2.
    """

    def __init__(self, axis: SpectralAxis, bias: float = 0.0) -> None:
        from filterpy.kalman import KalmanFilter

        model = axis.model
        n, N = len(model.Q), len(axis.first)
        self.model, self.outputs = model, np.zeros((2, N))
        self.outputs[:, :n] = axis.outputs
        self.kf = KalmanFilter(dim_x=N, dim_z=1)
        self.kf.x[n] = bias
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

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""
        return float(self.kf.x[len(self.model.Q), 0])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the measurements of the next steps, shape (steps,) each; return the estimates."""
        result = AxisEstimates.make_empty(len(force))
        kf, model, C = self.kf, self.model, self.outputs
        for k, (sample, fix) in enumerate(zip(force, fixes, strict=True)):
            kf.predict(F=self.predict)
            kf.update(sample, R=model.r_fast, H=self.force_row)
            if not np.isnan(fix):
                kf.update(fix, R=model.r_slow, H=self.fix_row)
                result.innovation[k], result.variance[k] = kf.y[0, 0], kf.S[0, 0]
            result.state[k], result.covariance[k] = C @ kf.x[:, 0], C @ kf.P @ C.T
            if model.copies and (self.step + model.delay) % model.interval == 0:
                kf.x, kf.P = self.copy @ kf.x, self.copy @ kf.P @ self.copy.T
            self.step += 1
        return result


class CompiledAxisFilter:
    """The Kalman filter of one axis, compiled, with gains computed on the way; see `AxisFilter`.

    Parameters
    ----------
    axis
        The model.
    bias
        Estimate of the IMU's bias one step before the first, m/s^2.
    """

    def __init__(self, axis: SpectralAxis, bias: float = 0.0) -> None:
        N = len(axis.first)
        self._axis, self._step = axis, 0
        self._register = np.zeros(N), axis.first.copy(), np.empty(N)
        self._register[0][len(axis.model.Q)] = bias

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""
        return float(self._register[0][len(self._axis.model.Q)])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the measurements of the next steps, shape (steps,) each; return the estimates."""
        from owtsweep.studies.hub.kernels.spectral_online import take_samples

        result, axis = AxisEstimates.make_empty(len(force)), self._axis
        samples = np.ascontiguousarray(force), np.ascontiguousarray(fixes)
        filled = tuple(result)
        take_samples(self._step, samples, axis.model, axis.outputs, self._register, filled)
        self._step += len(force)
        return result


class ScheduledFilter:
    """A filter that takes its gains from a schedule, as long as all fixes arrive; see `AxisFilter`.

    When a fix is missing, the covariance of that step is computed from the filter's start, and from
    then on at each step. The result is the Kalman filter's in either case.

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
