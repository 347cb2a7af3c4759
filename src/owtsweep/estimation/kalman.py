"""The Kalman filter for any number of states and any pattern of lost measurements.

Gains and covariances depend on the model and on which measurements there are, never on their
values. They are computed once for each pattern of losses (`compute_gains`, or `schedule_gains` for
one that repeats) and applied to all series that share it (`apply_gains`). The formulas are in
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

#: Distance from the periodic covariance, relative to the states' variances, that is negligible.
TOLERANCE = 1e-13


@dataclass(frozen=True)
class Gains:
    """Gains and covariances for each pattern of losses; they do not depend on data.

    Attributes
    ----------
    available
        (patterns, rows, m): whether a component of the measurement exists.
    K
        (patterns, rows, n, m), zero in the columns of lost components.
    innovation_covariance
        (patterns, rows, m, m), the identity in the rows and columns of lost components.
    predicted, filtered
        (patterns, rows, n, n): covariances of the state before and after the measurement.
    cycle
        The last `cycle` rows repeat for ever; with 0, each step has its own row.
    """

    available: NDArray[np.bool_]
    K: Array
    innovation_covariance: Array
    predicted: Array
    filtered: Array
    cycle: int = 0

    def rows_of(self, steps: int) -> NDArray[np.int64]:
        """(steps,): the row that serves each step of a record.

        Raises
        ------
        InputError
            If the record is longer than gains that do not repeat.
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
    """A filter's run over some series.

    Attributes
    ----------
    model
        The model of the filter.
    gains
        Gains and covariances of each pattern of losses.
    pattern
        (series,): index of each series' pattern.
    predicted, filtered
        (series, steps, n): the state before and after the step's measurement.
    innovation
        (series, steps, m): z - H x, NaN where the component was lost.
    """

    model: LinearModel
    gains: Gains
    pattern: NDArray[np.int64]
    predicted: Array
    filtered: Array
    innovation: Array

    @property
    def covariance(self) -> Array:
        """(series, steps, n, n) of the filtered states."""
        return self._of_series(self.gains.filtered)

    @property
    def innovation_covariance(self) -> Array:
        """(series, steps, m, m), the identity in the rows and columns of lost components."""
        return self._of_series(self.gains.innovation_covariance)

    @property
    def nis(self) -> Array:
        """NIS e' S^-1 e of the innovations e, (series, steps); zero where there is none.

        If the model is right, its expectation is the number of components that exist
        (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
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
    """Filter some series.

    Parameters
    ----------
    measurements
        (series, steps, m), NaN where a component was lost.
    state
        (n,) or (series, n): the expected state of step 0 before its measurement.
    covariance
        (n, n): the covariance of that state.
    inputs
        (steps, p) or (series, steps, p) if the model has B; input k acts between steps k and k + 1.

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
    """Gains and covariances of some patterns of losses.

    Parameters
    ----------
    covariance
        (n, n) of the state of step 0 before its measurement.
    available
        (patterns, steps, m): whether a component of the measurement exists.
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
    """Gains of one pattern of losses that repeats: after a transient, so do the gains.

    With a model that does not change and a fixed cycle (one sensor slower than another, for
    example) the covariance converges to a periodic one (Anderson and Moore 1979, section 4.4, for a
    cycle of one step). The transient and one cycle then serve records of any length.

    Parameters
    ----------
    model
        The model, with matrices that have no axis of time.
    covariance
        (n, n) of the state of step 0 before its measurement.
    available
        (cycle, m): whether a component of the measurement exists, over one cycle.
    steps
        Length of the longest record. If the covariance has not settled by then, every step has its
        own row. (The covariance of a state that nothing observes never settles.)

    Raises
    ------
    InputError
        If the model changes with time, or the pattern does not fit it.
    """
    there = np.asarray(available, dtype=bool)
    if model.steps is not None:
        raise InputError("model: changes with time; a schedule needs one without an axis of time")
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
    """Largest change of a covariance, relative to the variances of the two states concerned."""
    scale = np.sqrt(np.diagonal(after))
    scale = np.where(scale > 0.0, scale, 1.0)
    return float(np.max(np.abs(after - before) / np.outer(scale, scale)))


def _is_settled(before: float, change: float) -> bool:
    """Whether all changes still to come are within the tolerance.

    While changes fall by the factor r = change / before per cycle, those to come sum to
    change r / (1 - r). Changes that no longer fall are round-off.
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
    """Filter some series with given gains; other parameters are as for `run_filter`.

    Parameters
    ----------
    pattern
        (series,): index of each series' pattern in the gains; None for the first pattern.

    Raises
    ------
    InputError
        If shapes do not fit, or the components that a series lost differ from its pattern.
    """
    z = check_measurements(model, measurements)
    series, steps, _ = z.shape
    if pattern is None:
        pattern = np.zeros(series, dtype=np.int64)
    rows = gains.rows_of(steps)
    if np.any(np.isfinite(z) != share_out(gains.available[:, rows], pattern)):
        raise InputError("measurements: other components are lost than the gains are made for")
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
