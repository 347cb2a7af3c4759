"""The Kalman filter for measurements that arrive late, each with its own delay.

At every step the filter goes back to the earliest step whose measurement has just arrived, and
filters from that step again with all measurements that have arrived. The result is exact for any
delays. The extra cost is one step of filtering per step of delay. (Another exact method extends the
state by a copy of the state for every step of the longest delay.)
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
    compute_input_effects,
    find_patterns,
    share_out,
    spread_state,
)
from owtsweep.estimation.kalman_step import (
    compute_nis,
    correct_covariance,
    correct_state,
    multiply,
    predict_covariance,
    transpose,
)
from owtsweep.estimation.linear import LinearModel
from owtsweep.estimation.smoothing import compute_smoother_gain


@dataclass(frozen=True)
class Delayed:
    """The estimates of a filter whose measurements arrive late.

    Attributes
    ----------
    state
        Shape (series, steps, n), for n states. Row k estimates the state at step k from all
        measurements that have arrived by step k + lag, or by the record's end if that is earlier.
        `lag` is the argument of `filter_delayed`.
    covariance
        Covariances of the errors of `state`, shape (series, steps, n, n).
    nis
        Shape (series, steps): normalised innovation squared (NIS) of the measurements that arrived
        at each step, given the measurements that arrived earlier. If the model is right, the
        expectation of NIS is `arrived`.
    arrived
        Shape (series, steps): number of measurement components that arrived at each step.
    """

    state: Array
    covariance: Array
    nis: Array
    arrived: NDArray[np.int64]


def filter_delayed(
    model: LinearModel,
    measurements: Array,
    delay: NDArray[np.int64] | int,
    *,
    state: Array,
    covariance: Array,
    inputs: Array | None = None,
    lag: int = 0,
) -> Delayed:
    """Estimate the states of several series whose measurements arrive late.

    Parameters
    ----------
    model
        The model, with n states, measurements of m components, and p inputs if it has B.
    measurements
        Shape (series, steps, m). Row k is measured at step k, even if it arrives later. A component
        that never arrives is NaN.
    delay
        Number of steps from a measurement to its arrival, at least 0: one number, or any shape that
        broadcasts to (series, steps, m). Measurements that arrive after the record's end are not
        used.
    state
        Expected state at step 0 before the first measurement, shape (n,) or (series, n).
    covariance
        Covariance of the error of `state`, shape (n, n).
    inputs
        Shape (steps, p) or (series, steps, p); input k acts between steps k and k + 1. None if the
        model has no B.
    lag
        Number of steps, at least 0, by which the estimate of a step waits for further
        measurements. With 0 this is a filter, otherwise a smoother with a fixed lag.

    Raises
    ------
    InputError
        If shapes do not fit, a delay or the lag is negative, or `covariance` is not a covariance.
    """
    z = check_measurements(model, measurements)
    if lag < 0:
        raise InputError(f"lag: {lag} steps; give 0 or more")
    arrival, pattern = find_patterns(_arrivals(z, np.asarray(delay)))
    series, steps, _ = z.shape
    chain = _Chain(model, z, arrival, pattern, compute_input_effects(model, inputs, series, steps))
    chain.begin(spread_state(model, state, series), check_prior(model, covariance))
    smoothed, spread = np.empty_like(chain.filtered), np.empty_like(chain.filtered_P)
    nis = np.empty((series, steps))
    for now, first in enumerate(_earliest(arrival)):
        # The NIS of all measurements is the sum over steps, in whatever order they arrived. The
        # NIS of the new measurements is therefore the increase of this sum.
        before = chain.nis[:, first:now].sum(axis=1)
        chain.filter_again(first, now)
        nis[:, now] = chain.nis[:, first : now + 1].sum(axis=1) - before
        oldest = max(now - lag, 0)
        if now >= lag or now == steps - 1:
            states, covariances = chain.smooth_back(now, oldest)
            due = slice(oldest, now + 1 if now == steps - 1 else oldest + 1)
            count = due.stop - due.start
            smoothed[:, due], spread[:, due] = states[:, :count], covariances[:, :count]
    counts = [np.bincount(np.minimum(a.ravel(), steps), minlength=steps + 1) for a in arrival]
    arrived = np.stack(counts)[pattern, :steps]
    P = share_out(spread, pattern)
    return Delayed(smoothed, np.broadcast_to(P, (series, *P.shape[1:])), nis, arrived)


def _arrivals(z: Array, delay: NDArray[np.int64]) -> NDArray[np.int64]:
    """Compute the step at which each component of the measurements arrives.

    Parameters
    ----------
    z
        Measurements, shape (series, steps, m); NaN where a component never arrives.
    delay
        Number of steps from a measurement to its arrival; any shape that broadcasts to that of `z`.

    Returns
    -------
    array
        Shape (series, steps, m); the largest integer for a component that never arrives.

    Raises
    ------
    InputError
        If a delay is not a whole number >= 0, or the shape of `delay` does not fit that of `z`.
    """
    if not np.issubdtype(delay.dtype, np.integer) or np.any(delay < 0):
        raise InputError("delay: give whole numbers of steps, 0 or more")
    try:
        late = np.broadcast_to(delay, z.shape)
    except ValueError:
        raise InputError(
            f"delay: the shape {delay.shape} does not fit measurements of {z.shape}"
        ) from None
    step = np.arange(z.shape[1])[:, None]
    return np.where(np.isfinite(z), step + late, np.iinfo(np.int64).max)


def _earliest(arrival: NDArray[np.int64]) -> list[int]:
    """Find, for each step, the step from which the filter must run again.

    Return one entry per step k: the earliest step of which a measurement arrives at step k, or k
    if no earlier measurement arrives at step k. `arrival`, shape (patterns, steps, m), is the step
    at which each component of the measurements arrives.
    """
    steps = arrival.shape[1]
    earliest = np.arange(steps)
    _, about, _ = np.nonzero(arrival < steps)
    np.minimum.at(earliest, arrival[arrival < steps], about)
    return [int(step) for step in earliest]


class _Chain:
    """The states of a filter at all steps up to now, given the measurements that have arrived.

    Series whose measurements arrive at the same steps share a pattern, and so their covariances.

    Attributes
    ----------
    predicted, filtered
        States before and after the measurement of each step, shape (series, steps, n).
    predicted_P, filtered_P
        Covariances of `predicted` and `filtered`, shape (patterns, steps, n, n).
    nis
        Normalised innovation squared of the measurements taken at each step, shape (series, steps).
    """

    def __init__(
        self,
        model: LinearModel,
        z: Array,
        arrival: NDArray[np.int64],
        pattern: NDArray[np.int64],
        driven: Array,
    ) -> None:
        self.model, self.z, self.driven = model, z, driven
        self.arrival, self.pattern = arrival, pattern
        series, steps, _ = z.shape
        n = model.states
        self.predicted, self.filtered = np.empty((2, series, steps, n))
        self.predicted_P, self.filtered_P = np.empty((2, len(arrival), steps, n, n))
        self.nis = np.zeros((series, steps))

    def begin(self, state: Array, covariance: Array) -> None:
        """Set the expected state and the covariance at step 0, before the measurement of step 0."""
        self.predicted[:, 0], self.predicted_P[:, 0] = state, covariance

    def filter_again(self, first: int, now: int) -> None:
        """Filter the steps `first` to `now` again, with all measurements that arrived by `now`."""
        for k in range(first, now + 1):
            if k > 0:
                F, Q, _, _, _ = self.model.at(k - 1)
                self.predicted[:, k] = self.filtered[:, k - 1] @ F.T + self.driven[:, k - 1]
                self.predicted_P[:, k] = predict_covariance(self.filtered_P[:, k - 1], F, Q)
            _, _, H, R, _ = self.model.at(k)
            there = self.arrival[:, k] <= now
            K, S, self.filtered_P[:, k] = correct_covariance(self.predicted_P[:, k], H, R, there)
            e = np.where(
                share_out(there, self.pattern), self.z[:, k] - self.predicted[:, k] @ H.T, 0.0
            )
            self.filtered[:, k] = correct_state(self.predicted[:, k], share_out(K, self.pattern), e)
            self.nis[:, k] = compute_nis(e, share_out(S, self.pattern))

    def smooth_back(self, now: int, oldest: int) -> tuple[Array, Array]:
        """Smooth the steps `oldest` to `now`, given all measurements that have arrived by `now`.

        Returns
        -------
        tuple of array
            Smoothed states, shape (series, now - oldest + 1, n), and their covariances, shape
            (patterns, now - oldest + 1, n, n).
        """
        window = slice(oldest, now + 1)
        x, P = self.filtered[:, window].copy(), self.filtered_P[:, window].copy()
        for k in range(now - 1, oldest - 1, -1):
            C = compute_smoother_gain(
                self.filtered_P[:, k], self.model.at(k).F, self.predicted_P[:, k + 1]
            )
            ahead = x[:, k + 1 - oldest] - self.predicted[:, k + 1]
            x[:, k - oldest] += multiply(share_out(C, self.pattern), ahead)
            wider = P[:, k + 1 - oldest] - self.predicted_P[:, k + 1]
            P[:, k - oldest] += C @ wider @ transpose(C)
        return x, P
