"""Filters of one axis of SKF, step by step: the interface, by filterpy, and compiled."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.spectral_model import LONGEST_TRANSIENT, SpectralAxis


class AxisEstimates(NamedTuple):
    """What a filter makes of the measurements of some steps along one axis.

    state: position (m) and velocity (m/s), shape (steps, 2).
    covariance: of the error of `state`, shape (steps, 2, 2).
    innovation, variance: innovation of the fix, m, and its variance, m^2, shape (steps,) each; NaN
        without a fix.
    """

    state: Array
    covariance: Array
    innovation: Array
    variance: Array

    @classmethod
    def make_empty(cls, steps: int) -> AxisEstimates:
        return cls(np.empty((steps, 2)), np.empty((steps, 2, 2)), *np.full((2, steps), np.nan))


class AxisFilter(Protocol):
    """A running filter of one axis; its first step is a step at which a fix is due."""

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""
        ...

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the next specific forces, m/s^2, and position fixes, m, shape (steps,) each.

        Fixes are NaN at steps without one, and come only at multiples of the fix interval.
        """
        ...


class KalmanAxisFilter:
    """The Kalman filter of one axis, by filterpy; `bias` is its first estimate, m/s^2."""

    def __init__(self, axis: SpectralAxis, bias: float = 0.0) -> None:
        from filterpy.kalman import KalmanFilter

        from owtsweep.estimation.late import copying, measurement_rows, transition

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
        self.force_row, self.fix_row = (row[None] for row in measurement_rows(model))
        self.step = 0

    @property
    def bias(self) -> float:
        return float(self.kf.x[len(self.model.Q), 0])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
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
    """The Kalman filter of one axis, compiled; `bias` is its first estimate, m/s^2.

    Its gains are those of the model as long as all fixes arrive. From the first fix that is missing
    on, they are computed for the fixes that have arrived.
    """

    def __init__(self, axis: SpectralAxis, bias: float = 0.0) -> None:
        from owtsweep.estimation.late import start_lanes

        self._axis, self._step = axis, 0
        self._state = start_lanes(len(axis.first), 1)
        self._state.x["x"][len(axis.model.Q)] = bias
        self._covariance: Array | None = None  # None while no fix was missing

    @property
    def bias(self) -> float:
        return float(self._state.x["x"][len(self._axis.model.Q), 0])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        parts, done = [], 0
        while done < len(force):
            count = self._count_steps(fixes[done:])
            parts.append(self._run(force[done : done + count], fixes[done : done + count]))
            done += count
        if len(parts) == 1:
            return parts[0]
        return AxisEstimates(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    def _count_steps(self, fixes: Array) -> int:
        """Return for how many of the next steps gains are found in the same way."""
        from owtsweep.estimation.late import CHUNK

        if self._covariance is None:
            interval = self._axis.model.interval
            first = -self._step % interval
            missing = np.flatnonzero(np.isnan(fixes[first::interval]))
            if not len(missing):
                return len(fixes)
            count = first + int(missing[0]) * interval
            if count > 0:
                return count
            self._covariance = self._axis.gains.find_covariance(self._step)
        return min(len(fixes), CHUNK)

    def _run(self, force: Array, fixes: Array) -> AxisEstimates:
        from owtsweep.estimation.late import follow, prepare_estimates

        steps, first, model, gains = len(force), self._step, self._axis.model, self._axis.gains
        due = slice(-first % model.interval, None, model.interval)
        fixes = fixes[due]
        if self._covariance is None:
            rows, base = gains.find(min(first + steps, LONGEST_TRANSIENT)), 0
        else:
            arrived = ~np.isnan(fixes)
            rows = gains.compute_with_losses(first, steps, arrived, self._covariance)
            base = first
        found = prepare_estimates(steps, len(fixes), 1)
        follow(
            first, base, np.ascontiguousarray(force)[:, None],
            np.ascontiguousarray(fixes)[:, None], 0, model, self._axis.outputs, rows, self._state,
            found,
        )  # fmt: skip
        self._step += steps
        innovation, variance = np.full((2, steps), np.nan)
        innovation[due], variance[due] = found.innovation[:, 0], found.variance
        return AxisEstimates(found.outputs[:, :, 0], found.covariance, innovation, variance)
