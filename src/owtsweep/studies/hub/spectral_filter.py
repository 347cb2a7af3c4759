"""Filters of one axis of SKF, step by step: the interface, by filterpy, and compiled."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.late import (
    copying,
    follow,
    measurement_rows,
    prepare_estimates,
    process_noise,
    start_lanes,
    transition,
)
from owtsweep.estimation.weighing import (
    ALIKE,
    WeighedEstimates,
    WeighedState,
    Weighing,
    follow_weighing,
    weigh,
)
from owtsweep.studies.hub.spectral_model import LONGEST_TRANSIENT, SpectralAxis

#: Greatest scaled difference of two covariances that count as one: it moves an estimate by a
#: millionth of its standard deviation.
SAME = 1e-6
#: Most steps that are filtered before it is seen whether all fixes counted fully.
PIECE = 8192


class AxisEstimates(NamedTuple):
    """What a filter makes of the measurements of some steps along one axis.

    state: position (m) and velocity (m/s), shape (steps, 2).
    covariance: of the error of `state`, shape (steps, 2, 2).
    innovation, variance: innovation of the fix, m, and its variance, m^2, shape (steps,) each; NaN
        without a fix.
    weight: weight of the fix, from 0 to 1, shape (steps,); NaN without a fix.
    """

    state: Array
    covariance: Array
    innovation: Array
    variance: Array
    weight: Array

    @classmethod
    def make_empty(cls, steps: int) -> AxisEstimates:
        return cls(np.empty((steps, 2)), np.empty((steps, 2, 2)), *np.full((3, steps), np.nan))


class AxisFilter(Protocol):
    """A running filter of one axis; its first step is a step at which a fix is due."""

    @property
    def bias(self) -> float:
        """The estimated bias of the IMU along the axis, m/s^2."""

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take the next specific forces, m/s^2, and position fixes, m, shape (steps,) each.

        Fixes are NaN at steps without one, and come only at multiples of the fix interval.
        """


class KalmanAxisFilter:
    """The Kalman filter of one axis, by filterpy.

    rule: how much a fix counts that is far from its prediction.
    bias: its first estimate, m/s^2.
    """

    def __init__(self, axis: SpectralAxis, rule: Weighing = ALIKE, bias: float = 0.0) -> None:
        from filterpy.kalman import KalmanFilter

        model = axis.model
        n, N = len(model.Q), len(axis.first)
        self.model, self.outputs = model, np.zeros((2, N))
        self.outputs[:, :n] = axis.outputs
        self.kf = KalmanFilter(dim_x=N, dim_z=1)
        self.kf.x[n] = bias
        self.kf.P = axis.first.copy()
        self.kf.Q = process_noise(model)
        self.rule, self.beyond = rule, np.zeros(1, dtype=np.int64)
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
                residual = fix - (self.fix_row @ kf.x)[0, 0]
                variance = (self.fix_row @ kf.P @ self.fix_row.T)[0, 0] + model.r_slow
                weight = weigh(abs(residual) / np.sqrt(variance), self.rule, self.beyond)
                if weight > 0.0:
                    raised = model.r_slow + (1.0 / weight - 1.0) * variance
                    kf.update(fix, R=raised, H=self.fix_row)
                result.innovation[k], result.variance[k] = residual, variance
                result.weight[k] = weight
            result.state[k], result.covariance[k] = C @ kf.x[:, 0], C @ kf.P @ C.T
            if model.copies and (self.step + model.delay) % model.interval == 0:
                kf.x, kf.P = self.copy @ kf.x, self.copy @ kf.P @ self.copy.T
            self.step += 1
        return result


class CompiledAxisFilter:
    """The Kalman filter of one axis, compiled; `rule` and `bias` are as of `KalmanAxisFilter`.

    Its gains are those of the model as long as all fixes arrive and count fully. From the first fix
    on that does not, they follow from the fixes, until the covariance is that of the model again.
    """

    def __init__(self, axis: SpectralAxis, rule: Weighing = ALIKE, bias: float = 0.0) -> None:
        self._axis, self._rule, self._step = axis, rule, 0
        self._lanes = start_lanes(len(axis.first), 1)
        self._lanes.x["x"][len(axis.model.Q)] = bias
        self._weighed: WeighedState | None = None  # None while all fixes count fully
        self._odd_at = 0  # the last step at which a fix did not

    @property
    def bias(self) -> float:
        x = self._lanes.x["x"][:, 0] if self._weighed is None else self._weighed.x
        return float(x[len(self._axis.model.Q)])

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        parts, done = [], 0
        while done < len(force):
            take = self._follow if self._weighed is None else self._weigh
            parts.append(take(force[done : done + PIECE], fixes[done : done + PIECE]))
            done += len(parts[-1].state)
        return join(parts)

    def _follow(self, force: Array, fixes: Array) -> AxisEstimates:
        """Run on the model's own gains until a fix does not count fully."""
        before, interval = self._lanes.x.copy(), self._axis.model.interval
        due = np.arange(-self._step % interval, len(force), interval)
        result = self._run(force, fixes, due)
        distance = np.abs(result.innovation[due]) / np.sqrt(result.variance[due])
        # a missing fix has the distance NaN
        odd = due[~(distance <= self._rule.limit)]
        if len(odd):
            stop = int(odd[0])
            self._lanes.x[:] = before
            result = self._run(force[:stop], fixes[:stop], due[due < stop])
            self._step += stop
            self._start_weighing()
        else:
            self._step += len(force)
        return result

    def _run(self, force: Array, fixes: Array, due: NDArray[np.int64]) -> AxisEstimates:
        steps, model = len(force), self._axis.model
        rows = self._axis.gains.find(min(self._step + steps, LONGEST_TRANSIENT))
        found = prepare_estimates(steps, len(due), 1)
        follow(
            self._step, np.ascontiguousarray(force)[:, None], fixes[due][:, None], 0, model,
            self._axis.outputs, rows, self._lanes, found,
        )  # fmt: skip
        innovation, variance, weight = np.full((3, steps), np.nan)
        innovation[due], variance[due], weight[due] = found.innovation[:, 0], found.variance, 1.0
        return AxisEstimates(found.outputs[:, :, 0], found.covariance, innovation, variance, weight)

    def _start_weighing(self) -> None:
        """Go on, at a step at which a fix is due, with gains that follow from the fixes."""
        x = self._lanes.x["x"][:, 0].copy()
        self._weighed = WeighedState(x, self._find_covariance(), np.zeros(1, dtype=np.int64))

    def _find_covariance(self) -> Array:
        """Return the covariance before the next step if all fixes had counted fully."""
        gains = self._axis.gains
        rows = gains.find(min(self._step, LONGEST_TRANSIENT))
        return gains.find_covariance(min(self._step, len(rows.fast)))

    def _weigh(self, force: Array, fixes: Array) -> AxisEstimates:
        """Run on gains that follow from the fixes, up to where the model's may do again."""
        assert self._weighed is not None
        weighed, model, span = self._weighed, self._axis.model, self._axis.gains.span
        steps = min(span - self._step % span, len(force))
        filled = AxisEstimates.make_empty(steps)
        follow_weighing(
            self._step, np.ascontiguousarray(force[:steps]), np.ascontiguousarray(fixes[:steps]),
            model, self._axis.outputs, self._rule, weighed, WeighedEstimates(*filled),
        )  # fmt: skip
        due = np.arange(-self._step % model.interval, steps, model.interval)
        odd = due[~(filled.weight[due] == 1.0)]
        if len(odd):
            self._odd_at = self._step + int(odd[-1])
        self._step += steps
        if self._step % span == 0 and self._step - self._odd_at >= span:
            covariance = self._find_covariance()
            scale = np.sqrt(np.diagonal(covariance))
            if np.all(np.abs(weighed.P - covariance) <= SAME * np.outer(scale, scale)):
                self._lanes.x["x"][:, 0], self._weighed = weighed.x, None
        return filled


def join(parts: Sequence[AxisEstimates]) -> AxisEstimates:
    """Join the estimates of successive steps."""
    if not parts:
        return AxisEstimates.make_empty(0)
    if len(parts) == 1:
        return parts[0]
    return AxisEstimates(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
