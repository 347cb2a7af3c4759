"""Gains of a Kalman filter with a slow and a fast measurement, and of its fixed-lag smoother.

The gains depend on the model and on the variances of noise, not on the measured values, so all
records share them. After a transient the gains are periodic: a cycle is the time from one slow
measurement to the next. Source: Algorithms 6 to 8 of Ren et al. (2019).

`FixedLagSmoother` makes one pass over the whole window at every step, as Algorithms 7 and 8 do.
`smoother_gains` gives the same smoothed states by a recursion whose effort per step does not depend
on the window.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.errors import InputError
from owtsweep.estimation.riccati import GainRows, Pattern, TwoRates, recursion
from owtsweep.estimation.windowing import leaving

#: Rules for steps without a slow measurement (a position fix); see REPRODUCTION.md, rows "Alg. 6"
#: and "EKF". Equations and sections are those of Ren et al. (2019).
#: proper: the slow rows of H are dropped (Joseph form). mask_columns: K is computed from all rows,
#: then its slow columns are set to zero (text of section 4.3.3), with P = (I - K H) P as printed.
#: mask_rows: K(1:2, :) = 0 as printed in Algorithm 6, and the last fix is held. every_step: the
#: innovation is set to zero, while gain and covariance are computed as if there were a fix at every
#: step (section 5.3's EKF).
RULES = ("proper", "mask_columns", "mask_rows", "every_step")

#: Largest scaled change of the covariance over a cycle that still counts as converged.
TOLERANCE = 1e-13


@dataclass(frozen=True)
class GainSchedule:
    """The gains and covariances of a filter with a slow and a fast measurement, a row per step.

    K: gains, shape (rows, states, 2): columns of the slow and of the fast measurement.
    applied: whether a slow measurement corrects the state, new or old, shape (rows,).
    fresh: whether there is a new slow measurement, shape (rows,). At the other steps, the rule
        "mask_rows" applies the last one again.
    innovation_variance: variance H P H' + R of the slow measurement's innovation, shape (rows,).
    predicted, filtered: covariances of the state before and after the measurements of a step, shape
        (rows, states, states).
    cycle: number of rows at the end that repeat for ever, i.e. steps from one slow measurement to
        the next.
    """

    K: Array
    applied: NDArray[np.bool_]
    fresh: NDArray[np.bool_]
    innovation_variance: Array
    predicted: Array
    filtered: Array
    cycle: int

    @property
    def rows(self) -> int:
        return len(self.K)

    def row(self, step: NDArray[np.int64] | int) -> NDArray[np.int64]:
        """Return the index of the row with the gains of a step, or of each of several steps."""
        step = np.asarray(step)
        settled = self.rows - self.cycle
        return np.where(step < self.rows, step, settled + (step - settled) % self.cycle)

    def fresh_before(self, step: int) -> int:
        """Return the number of new slow measurements in the steps 0 to `step` - 1."""
        return int(np.count_nonzero(self.fresh[self.row(np.arange(step))]))


def schedule(
    rates: TwoRates,
    initial_covariance: Array,
    *,
    interval: int,
    steps: int,
    start_interval: int | None = None,
    start_steps: int = 0,
) -> GainSchedule:
    """Compute a filter's gains by the covariance recursion of Algorithm 6 of Ren et al. (2019).

    The recursion stops when the covariances repeat, or after `steps` steps, the length of the
    longest record (rounded up to a multiple of `interval`).

    initial_covariance: covariance (states, states) of the state one step before the first step.
    interval: number of steps from one slow measurement to the next; step 0 has one.
    start_interval, start_steps: in the first `start_steps` steps, slow measurements come every
        `start_interval` steps (None: every `interval`).
    Raises InputError if a variance of a state becomes negative or not finite, because the rule or
    the noise variances make the recursion unstable.
    """
    n, rule = len(rates.A), RULES[rates.rule]
    pattern = Pattern(interval, start_interval or interval, start_steps)
    rows = min(4096, steps)
    gains = GainRows(*(np.empty((0, *shape)) for shape in ((n, 2), (), (n, n), (n, n))))
    filled, quiet, repeats = 0, 0, False
    while not repeats and (filled == 0 or filled < steps):
        rows = min(-(-rows // interval) * interval, -(-steps // interval) * interval)
        gains = GainRows(*(_lengthen(array, rows, filled) for array in gains))
        first = filled
        filled, repeats, quiet = recursion(
            first, rows, quiet, rates, initial_covariance, pattern, TOLERANCE, gains
        )
        _check(gains.Pf, first, filled, rule)
        rows *= 4
    filled = max(-(-filled // interval) * interval, interval)
    step = np.arange(filled)
    fresh = step % np.where(step < start_steps, pattern.start_interval, interval) == 0
    applied = fresh | (rule == "mask_rows")
    K, S, Pm, Pf = (array[:filled] for array in gains)
    return GainSchedule(K, applied, fresh, S, Pm, Pf, interval)


def _lengthen(array: Array, rows: int, filled: int) -> Array:
    result = aligned(rows, *array.shape[1:])
    result[:filled] = array[:filled]
    return result


def _check(filtered: Array, first: int, stop: int, rule: str) -> None:
    diagonal = np.diagonal(filtered[first:stop], axis1=1, axis2=2)
    wrong = np.any(~(np.isfinite(diagonal) & (diagonal >= 0.0)), axis=1)
    if np.any(wrong):
        raise InputError(
            f"update_rule: {rule!r} makes the covariance negative or infinite at step "
            f"{first + int(np.argmax(wrong))} with this tuning; use 'proper'"
        )


#: Rows of a schedule whose gains are computed at once.
_ROWS_AT_ONCE = 8192


class FixedLagSmoother:
    """A smoother with a fixed lag of N_s steps, Algorithms 7 and 8 of Ren et al. (2019).

    It stores the newest filtered state and the N_s (`window`) filtered states before it, each with
    its covariance (register 4 of the paper). The loop printed in the paper runs over columns
    N_s - 1 ... 0 of registers that have columns 1 ... N_s; here the lag is taken to be N_s steps.
    `transition` is the model's A, shape (states, states).
    """

    def __init__(self, transition: Array, window: int) -> None:
        self.transition = transition
        self.window = window
        self.register: deque[tuple[Array, Array, Array, Array]] = deque(maxlen=window + 1)

    def update(
        self, x: Array, P: Array, x_predicted: Array, P_predicted: Array
    ) -> tuple[Array, Array] | None:
        """Take a new step; return the smoothed state `window` steps earlier and its covariance.

        The result is None in the first `window` calls. x, P and x_predicted, P_predicted are state
        (states,) and covariance (states, states) after and before the measurement of the new step.
        """
        self.register.append((x, P, x_predicted, P_predicted))
        if len(self.register) <= self.window:
            return None
        xs, Ps = self.register[-1][0], self.register[-1][1]
        for j in range(self.window - 1, -1, -1):
            x_j, P_j = self.register[j][0], self.register[j][1]
            x_next, P_next = self.register[j + 1][2], self.register[j + 1][3]
            C = np.linalg.solve(P_next.T, (P_j @ self.transition.T).T).T
            xs = x_j + C @ (xs - x_next)
            Ps = P_j + C @ (Ps - P_next) @ C.T
        return xs, Ps


def smoother_gains(gains: GainSchedule, transition: Array, window: int) -> tuple[Array, Array]:
    """Compute the gains C and D of a recursion for a smoother with a fixed lag of `window` steps.

    The recursion goes backwards in time, from the smoothed state of step k to that of step k - 1.
    C_k is the gain of the Rauch-Tung-Striebel smoother at step k. D_k is -C_k ... C_{k+window-1}
    K_{k+window}, with the filter's gain K. The smoothed state of step k depends on the innovations
    of step k + window, but the smoothed state of step k - 1 must not; D_k times these innovations
    removes their contribution.

    transition: the model's transition matrix A, shape (states, states).
    C, D: one row per row of `gains`: C has the shape (rows, states, states), D (rows, states, 2).
        The two columns of D_k belong to the slow and to the fast measurement.
    """
    C, D = aligned(*gains.filtered.shape), aligned(*gains.K.shape)
    for first in range(0, gains.rows, _ROWS_AT_ONCE):  # the working copies stay small
        stop = min(first + _ROWS_AT_ONCE, gains.rows)
        rows = np.arange(first, stop)
        numerator = gains.filtered[rows] @ transition.T
        following = gains.predicted[gains.row(rows + 1)]
        C[rows] = np.linalg.solve(
            following.transpose(0, 2, 1), numerator.transpose(0, 2, 1)
        ).transpose(0, 2, 1)
    leaving(C, gains.K, window, gains.cycle, D)
    return C, D
