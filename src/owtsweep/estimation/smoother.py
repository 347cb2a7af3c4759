"""Smooths with a fixed lag over a moving window, Algorithms 7 and 8 of Ren et al. (2019).

`FixedLagSmoother` is the algorithm as written: at every step it makes one pass of Rauch, Tung and
Striebel over the window. `smoother_gains` computes the gains of a recursion that gives the same
output in O(1) per step.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from owtsweep.arrays import Array, aligned
from owtsweep.estimation.gains import GainSchedule

#: Rows of a schedule whose gains are computed at once.
_ROWS_AT_ONCE = 8192


class FixedLagSmoother:
    """The paper's register 4 and its smoothing pass (Algorithms 7 and 8 of Ren et al. 2019).

    The printed loop runs over columns N_s - 1 ... 0 of registers that have columns 1 ... N_s. A lag
    of N_s steps is meant. The window therefore holds the newest filtered state and the N_s states
    before it, each with its covariance. `window` is N_s; `transition` is the model's matrix A.
    """

    def __init__(self, transition: Array, window: int) -> None:
        self.transition = transition
        self.window = window
        self.register: deque[tuple[Array, Array, Array, Array]] = deque(maxlen=window + 1)

    def update(
        self, x: Array, P: Array, x_predicted: Array, P_predicted: Array
    ) -> tuple[Array, Array] | None:
        """Take a step's filtered state; return the smoothed state of `window` steps ago.

        Parameters
        ----------
        x, P
            Filtered state (states,) and covariance (states, states) of this step.
        x_predicted, P_predicted
            Predicted state and covariance of this step, before its measurement.

        Returns
        -------
        tuple of array, or None
            Smoothed state and covariance; None in the first `window` steps.
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
    """Compute the smoother's gains C_k and D_k for every row of a gain schedule.

    C_k are the gains of the Rauch-Tung-Striebel smoother, and
    D_k = -C_k ... C_{k+window-1} K_{k+window}. D_k removes the contribution of the innovations of
    step k + window from the smoothed state of step k, because the window of step k - 1 does not
    include them.

    Returns
    -------
    C, D
        Shapes (rows, states, states) and (rows, states, 2); the columns of D_k belong to the slow
        and to the fast measurement.
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
