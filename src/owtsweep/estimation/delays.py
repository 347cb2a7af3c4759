"""The Kalman filter for measurements that arrive late, each with its own delay.

At every step the filter goes back to the earliest step whose measurement has just arrived. From
there the filter runs again with all measurements that have arrived. The result is exact for any
delays.
The extra cost is one step of filtering per step of delay. (The other exact method has one large
state, with a copy of the state for every step of the longest delay.)
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
        Shape (series, steps, n): row k is the state of step k given all measurements that have
        arrived by step k + lag, or by the record's end. The lag is that of `filter_delayed`.
    covariance
        Covariances of `state`, shape (series, steps, n, n).
    nis
        Shape (series, steps): normalised innovation squared of the measurements that arrived at
        each step, given all that arrived earlier. The expectation of NIS is `arrived`.
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
    """Filter (or, with a lag, smooth) some series whose measurements arrive late.

    Parameters
    ----------
    measurements
        Shape (series, steps, m). Row k is measured at step k, whenever it arrives. A component
        that never arrives is NaN.
    delay
        Steps from measurement to arrival, at least 0: one number, or any shape that broadcasts to
        (series, steps, m). Measurements that arrive after the record's end are not used.
    state, covariance, inputs
        As for `estimation.kalman.run_filter`.
    lag
        Steps by which the estimate may wait for further measurements.

    Raises
    ------
    InputError
        If shapes do not fit, or a delay or the lag is negative.
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
    """Compute the step at which each measured component arrives, shape (series, steps, m).

    For a component that never arrives, return the largest integer.

    Raises
    ------
    InputError
        If delays are not whole numbers >= 0, or do not fit the measurements.
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
    """Find, for each step, the step from which to filter again when the step's measurements arrive.

    Return one entry per step: the earliest step whose measurements arrive at the present step, or
    the present step itself if none arrive.
    """
    steps = arrival.shape[1]
    earliest = np.arange(steps)
    _, about, _ = np.nonzero(arrival < steps)
    np.minimum.at(earliest, arrival[arrival < steps], about)
    return [int(step) for step in earliest]


class _Chain:
    """The filter's states from the record's start to now, given all that has arrived by now.

    The states `predicted` and `filtered` have the shape (series, steps, n), their covariances
    `predicted_P` and `filtered_P` (patterns, steps, n, n). `nis`, shape (series, steps), is the
    normalised innovation squared of the measurements taken at each step.
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
        """Set the state and covariance of step 0 before its measurement."""
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
            States (series, steps, n) and covariances (patterns, steps, n, n) of these steps.
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
