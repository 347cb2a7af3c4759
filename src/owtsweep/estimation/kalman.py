"""The Kalman filter for any number of states and any pattern of lost measurements.

A pattern of losses says which components of the measurements exist at each step. Gains and
covariances depend on the model and on this pattern, but not on the measured values. The gains are
therefore computed once for each pattern (`compute_gains`, or `schedule_gains` for a pattern that
repeats in time). `apply_gains` uses them for all series with that pattern. The formulas are in
`kalman_step`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.filter_data import (
    check_measurements,
    check_prior,
    check_steps,
    compute_input_effects,
    find_patterns,
    share_out,
    spread_state,
)
from owtsweep.estimation.kalman_step import (
    compute_nis,
    correct_covariance,
    correct_state,
    predict_covariance,
)
from owtsweep.estimation.linear import LinearModel

#: A distance from the periodic covariance is negligible below this, relative to the states'
#: variances.
TOLERANCE = 1e-13


@dataclass(frozen=True)
class Gains:
    """The gains and covariances of a Kalman filter, for each pattern of lost measurements.

    The model has n states, and a measurement has m components. There is one row per step, or fewer
    rows if the gains repeat.

    Attributes
    ----------
    available
        Shape (patterns, rows, m): whether a component of the measurement exists.
    K
        Gains, shape (patterns, rows, n, m); zero in the columns of lost components.
    innovation_covariance
        Covariances of the innovations, shape (patterns, rows, m, m). The rows and columns of lost
        components are those of the identity matrix.
    predicted, filtered
        Covariances of the state before and after the measurement, shape (patterns, rows, n, n).
    cycle
        Number of rows, at the end, that repeat for ever. If `cycle` is 0, no row repeats: each step
        has its own row.
    """

    available: NDArray[np.bool_]
    K: Array
    innovation_covariance: Array
    predicted: Array
    filtered: Array
    cycle: int = 0

    def rows_of(self, steps: int) -> NDArray[np.int64]:
        """Return the index of the row with the gains of each step of a record, shape (steps,).

        `steps` is the number of steps of the record.

        Raises
        ------
        InputError
            If the rows do not repeat, and there are fewer rows than `steps`.
        """
        rows, step = self.K.shape[1], np.arange(steps)
        if self.cycle:
            settled = rows - self.cycle
            return np.where(step < rows, step, settled + (step - settled) % self.cycle)
        if steps > rows:
            raise InputError(f"measurements: {steps} steps are more than the {rows} of the gains")
        return step


@dataclass(frozen=True)
class Filtered:
    """The results of a Kalman filter that was run over several series.

    Attributes
    ----------
    model
        The model of the filter, with n states and m components of a measurement.
    gains
        Gains and covariances for each pattern of lost measurements.
    pattern
        For each series, the index of its pattern in `gains`; shape (series,).
    predicted, filtered
        The states before and after each step's measurement, shape (series, steps, n).
    innovation
        Measurement z minus its prediction H x, shape (series, steps, m); NaN where a component of
        z was lost.
    """

    model: LinearModel
    gains: Gains
    pattern: NDArray[np.int64]
    predicted: Array
    filtered: Array
    innovation: Array

    @property
    def covariance(self) -> Array:
        """The covariances of the filtered states, shape (series, steps, n, n)."""
        return self._of_series(self.gains.filtered)

    @property
    def innovation_covariance(self) -> Array:
        """The covariances of the innovations, shape (series, steps, m, m).

        The rows and columns of lost components are those of the identity matrix.
        """
        return self._of_series(self.gains.innovation_covariance)

    @property
    def nis(self) -> Array:
        """The normalised innovation squared (NIS) of each step, shape (series, steps).

        NIS is e' S^-1 e, for the innovation e and its covariance S. At steps without a measurement,
        NIS is zero. If the model is right, the expectation of NIS is the number of components of
        the step's measurement that exist (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
        """
        return compute_nis(self.innovation, self.innovation_covariance)

    def _of_series(self, values: Array) -> Array:
        series, steps, _ = self.filtered.shape
        shared = share_out(values[:, self.gains.rows_of(steps)], self.pattern)
        return np.broadcast_to(shared, (series, *shared.shape[1:]))


def run_filter(
    model: LinearModel,
    measurements: Array,
    *,
    state: Array,
    covariance: Array,
    inputs: Array | None = None,
) -> Filtered:
    """Run a Kalman filter over several series.

    Parameters
    ----------
    model
        The model, with n states, measurements of m components, and p inputs if it has B.
    measurements
        Shape (series, steps, m); NaN where a component was lost.
    state
        Expected state at step 0 before the first measurement, shape (n,) or (series, n).
    covariance
        Covariance of the error of `state`, shape (n, n).
    inputs
        Shape (steps, p) or (series, steps, p); input k acts between steps k and k + 1. None if the
        model has no B.

    Raises
    ------
    InputError
        If shapes do not fit, or `covariance` is not a covariance.
    """
    z = check_measurements(model, measurements)
    patterns, pattern = find_patterns(np.isfinite(z))
    gains = compute_gains(model, covariance, patterns)
    return apply_gains(model, gains, z, state=state, inputs=inputs, pattern=pattern)


def compute_gains(model: LinearModel, covariance: Array, available: NDArray[np.bool_]) -> Gains:
    """Compute the gains and covariances of a Kalman filter for patterns of lost measurements.

    Parameters
    ----------
    model
        The model, with n states and m components of a measurement.
    covariance
        Covariance (n, n) of the state at step 0 before the first measurement.
    available
        Whether a component of the measurement exists, shape (patterns, steps, m).

    Raises
    ------
    InputError
        If the model's matrices depend on time and are given for fewer steps than `available` has,
        or `covariance` is not a covariance of n states.
    """
    patterns, steps, m = available.shape
    n = model.states
    check_steps(model, steps)
    K, S = np.empty((patterns, steps, n, m)), np.empty((patterns, steps, m, m))
    predicted, filtered = np.empty((2, patterns, steps, n, n))
    P = np.broadcast_to(check_prior(model, covariance), (patterns, n, n))
    for k in range(steps):
        F, Q, H, R, _ = model.at(k)
        predicted[:, k] = P
        K[:, k], S[:, k], filtered[:, k] = correct_covariance(P, H, R, available[:, k])
        P = predict_covariance(filtered[:, k], F, Q)
    return Gains(available, K, S, predicted, filtered)


def schedule_gains(
    model: LinearModel, covariance: Array, available: NDArray[np.bool_], steps: int
) -> Gains:
    """Compute the gains of a Kalman filter for measurements that are missing periodically.

    Measurements are missing periodically, for example, if one sensor is slower than another. If the
    model does not change with time, covariance and gains become periodic too (Anderson and Moore
    1979, section 4.4, for a period of one step). The gains of the transient and of one period,
    called a cycle, then serve records of any length.

    Parameters
    ----------
    model
        The model, with matrices that have no axis of time; n states and m components of a
        measurement.
    covariance
        Covariance (n, n) of the state at step 0 before the first measurement.
    available
        Whether a component of the measurement exists, for each step of one cycle; shape (cycle, m).
    steps
        Number of steps of the longest record. If the covariance is not periodic after `steps`
        steps, the gains have a row for every step, and no row repeats. (The covariance of a state
        that no measurement observes may never become periodic.)

    Raises
    ------
    InputError
        If the model changes with time, or `available` or `covariance` does not fit the model.
    """
    there = np.asarray(available, dtype=bool)
    if model.steps is not None:
        raise InputError("model: changes with time; give matrices without an axis of time")
    if there.ndim != 2 or len(there) == 0 or there.shape[1] != model.measurements:
        raise InputError(
            f"available: has the shape {there.shape}; give (cycle, {model.measurements})"
        )
    F, Q, H, R, _ = model.at(0)
    P = check_prior(model, covariance)[None]
    rows: list[tuple[Array, Array, Array, Array]] = []
    change, settled = np.inf, False
    while not settled and len(rows) < steps:
        first = P
        for now in there:
            K, S, filtered = correct_covariance(P, H, R, now[None])
            rows.append((K, S, P, filtered))
            P = predict_covariance(filtered, F, Q)
        before, change = change, _change(first[0], P[0])
        settled = _is_settled(before, change)
    K, S, predicted, filtered = (np.stack(column, axis=1) for column in zip(*rows, strict=True))
    repeated = np.tile(there, (len(rows) // len(there), 1))[None]
    cycle = len(there) if settled else 0
    return Gains(repeated, K, S, predicted, filtered, cycle)


def _change(before: Array, after: Array) -> float:
    """Return the largest absolute change of an element between two covariances (n, n).

    The change of element (i, j) is divided by the standard deviations of the states i and j in
    `after`, so the result has no unit.
    """
    scale = np.sqrt(np.diagonal(after))
    scale = np.where(scale > 0.0, scale, 1.0)
    return float(np.max(np.abs(after - before) / np.outer(scale, scale)))


def _is_settled(before: float, change: float) -> bool:
    """Return whether a covariance has converged, so that later changes are negligible.

    `change` is the change of the covariance in the last cycle, and `before` that in the cycle
    before. If the changes go on falling by the factor r = change / before per cycle, all later
    changes together are change r / (1 - r). Changes below `TOLERANCE` that no longer fall are
    round-off.
    """
    if change > TOLERANCE:
        return False
    return change >= before or change * change <= TOLERANCE * (before - change)


def apply_gains(
    model: LinearModel,
    gains: Gains,
    measurements: Array,
    *,
    state: Array,
    inputs: Array | None = None,
    pattern: NDArray[np.int64] | None = None,
) -> Filtered:
    """Run a Kalman filter over several series, with given gains.

    Parameters
    ----------
    model
        The model, with n states, measurements of m components, and p inputs if it has B.
    gains
        Gains for each pattern of lost measurements, from `compute_gains` or `schedule_gains`.
    measurements
        Shape (series, steps, m); NaN where a component was lost.
    state
        Expected state at step 0 before the first measurement, shape (n,) or (series, n).
    inputs
        Shape (steps, p) or (series, steps, p); input k acts between steps k and k + 1. None if the
        model has no B.
    pattern
        For each series, the index of its pattern in `gains`; shape (series,). None means that all
        series have the first pattern.

    Raises
    ------
    InputError
        If shapes do not fit, or a series lost other components than its pattern says.
    """
    z = check_measurements(model, measurements)
    series, steps, _ = z.shape
    if pattern is None:
        pattern = np.zeros(series, dtype=np.int64)
    rows = gains.rows_of(steps)
    if np.any(np.isfinite(z) != share_out(gains.available[:, rows], pattern)):
        raise InputError(
            "measurements: other components are lost than in `gains`; compute gains for these"
        )
    driven = compute_input_effects(model, inputs, series, steps)
    predicted, filtered = np.empty((2, series, steps, model.states))
    innovation = np.empty(z.shape)
    x = spread_state(model, state, series)
    for k, row in enumerate(rows):
        F, _, H, _, _ = model.at(k)
        predicted[:, k] = x
        innovation[:, k] = z[:, k] - x @ H.T
        filtered[:, k] = correct_state(x, share_out(gains.K[:, row], pattern), innovation[:, k])
        x = filtered[:, k] @ F.T + driven[:, k]
    return Filtered(model, gains, pattern, predicted, filtered, innovation)
