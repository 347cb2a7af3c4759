"""Smooth with a fixed lag over a moving window, Algorithms 7 and 8 of Ren et al. (2019).

`FixedLagSmoother` follows these algorithms: at every step it makes one pass of a smoother of Rauch,
Tung and Striebel over the whole window. `smoother_gains` computes the gains of a recursion that
gives the same smoothed states, with an effort per step that does not depend on the window.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.gains import GainSchedule

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
    from owtsweep.estimation.windowing import leaving

    C, D = aligned(*gains.filtered.shape), aligned(*gains.K.shape)
    for first in range(0, gains.rows, _ROWS_AT_ONCE):  # the working copies stay small
        stop = min(first + _ROWS_AT_ONCE, gains.rows)
        rows = np.arange(first, stop)
        numerator = gains.filtered[rows] @ transition.T
        following = gains.predicted[gains.row(rows + 1)]
        C[rows] = np.linalg.solve(
            following.transpose(0, 2, 1), numerator.transpose(0, 2, 1)
        ).transpose(0, 2, 1)
    leaving(0, gains.rows, C, gains.K, window, gains.cycle, D)
    return C, D
