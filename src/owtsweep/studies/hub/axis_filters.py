"""Filters of one axis of SKF, step by step: the interface, by filterpy, and compiled."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.late_gains import copying, transition
from owtsweep.studies.hub.spectral_axis import SpectralAxis


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
