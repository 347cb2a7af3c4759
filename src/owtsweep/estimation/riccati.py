"""The compiled covariance recursion of a Kalman filter with a slow and a fast measurement.

The fast measurement comes at every step, the slow one every `interval` steps. Symbols are those of
Algorithm 6 of Ren et al. (2019): covariance P, gain K, measurement rows H, measurement variances R,
and S = H P H' + R.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit, part

#: How the gain and the covariance treat a step without a slow measurement.
PROPER, MASK_COLUMNS, MASK_ROWS, EVERY_STEP = 0, 1, 2, 3


class TwoRates(NamedTuple):
    """A model in discrete time with a slow and a fast measurement.

    A, Q: transition matrix and covariance of the process noise, shape (n, n) each.
    slow, fast: rows (n,) of the measurement matrix. If `fast` is all zero, there is no fast
        measurement: the fast signal is an input of the model.
    r_slow, r_fast: variances of the noise of the two measurements.
    rule: how a step without a slow measurement is treated: PROPER, MASK_COLUMNS, MASK_ROWS or
        EVERY_STEP, explained at `estimation.gains.RULES`.
    """

    A: Array
    Q: Array
    slow: Array
    fast: Array
    r_slow: float
    r_fast: float
    rule: int


class Pattern(NamedTuple):
    """The steps at which slow measurements come.

    Before the step `start_steps`, they come at multiples of `start_interval` steps, and from this
    step on at multiples of `interval` steps.
    """

    interval: int
    start_interval: int
    start_steps: int


class GainRows(NamedTuple):
    """The arrays that the covariance recursion fills: one row per step.

    K: gains, shape (rows, n, 2): columns of the slow and of the fast measurement.
    S: variance of the slow measurement's innovation, shape (rows,).
    Pm, Pf: covariances of the state before and after the measurements of a step, shape
        (rows, n, n).
    """

    K: Array
    S: Array
    Pm: Array
    Pf: Array


@part
def riccati_step(model, P, is_slow, K, Pm, Pf, work):
    """Predict a covariance over one step, and correct it; return the slow innovation's variance.

    model: a `TwoRates` with n states.
    P: covariance of the state after the measurements of the previous step, shape (n, n).
    is_slow: whether this step has a slow measurement.
    K: array (n, 2) for the gains of the slow and of the fast measurement; overwritten.
    Pm, Pf: arrays (n, n) for the predicted and the corrected covariance; overwritten.
    work: array (3, n, n) for intermediate results; overwritten.
    """
    A, Q, slow, fast = model.A, model.Q, model.slow, model.fast
    r_slow, r_fast, rule = model.r_slow, model.r_fast, model.rule
    n = A.shape[0]
    has_fast = False
    for i in range(n):
        has_fast = has_fast or fast[i] != 0.0
    AP, L, LP = work[0], work[1], work[2]
    multiply(A, P, AP)
    for i in range(n):
        for j in range(n):
            total = Q[i, j]
            for m in range(n):
                total += AP[i, m] * A[j, m]
            Pm[i, j] = total
    make_symmetric(Pm)

    use_slow = is_slow or rule != PROPER
    ss, ff, sf = r_slow, r_fast, 0.0
    for i in range(n):
        hs, hf = 0.0, 0.0
        for j in range(n):
            hs += Pm[i, j] * slow[j]
            hf += Pm[i, j] * fast[j]
        K[i, 0], K[i, 1] = hs, hf  # still P H', not yet the gain
    for i in range(n):
        ss += slow[i] * K[i, 0]
        ff += fast[i] * K[i, 1]
        sf += slow[i] * K[i, 1]
    for i in range(n):
        hs, hf = K[i, 0], K[i, 1]
        if use_slow and has_fast:
            determinant = ss * ff - sf * sf
            K[i, 0] = (hs * ff - hf * sf) / determinant
            K[i, 1] = (hf * ss - hs * sf) / determinant
        elif use_slow:
            K[i, 0], K[i, 1] = hs / ss, 0.0
        elif has_fast:
            K[i, 0], K[i, 1] = 0.0, hf / ff
        else:
            K[i, 0], K[i, 1] = 0.0, 0.0
    if not is_slow:
        if rule == MASK_COLUMNS:
            for i in range(n):
                K[i, 0] = 0.0
        elif rule == MASK_ROWS:
            K[0, 0] = K[0, 1] = 0.0

    for i in range(n):
        for j in range(n):
            L[i, j] = -K[i, 0] * slow[j] - K[i, 1] * fast[j]
        L[i, i] += 1.0
    multiply(L, Pm, LP)
    joseph = rule in (PROPER, EVERY_STEP) or is_slow
    for i in range(n):
        for j in range(n):
            if joseph:
                total = r_slow * K[i, 0] * K[j, 0] + r_fast * K[i, 1] * K[j, 1]
                for m in range(n):
                    total += LP[i, m] * L[j, m]
                Pf[i, j] = total
            else:
                Pf[i, j] = LP[i, j]
    make_symmetric(Pf)
    return ss


@part
def multiply(A, B, product):
    """Write the product A B of matrices (n, n) into `product`, which is neither of them."""
    n = len(A)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for m in range(n):
                total += A[i, m] * B[m, j]
            product[i, j] = total


@part
def make_symmetric(P):
    """Replace the elements of a matrix beside its diagonal by the means with their opposites."""
    for i in range(len(P)):
        for j in range(i):
            P[i, j] = P[j, i] = 0.5 * (P[i, j] + P[j, i])


@njit
def recursion(first, stop, quiet, model, P0, pattern, tolerance, filled):
    """Compute the filter's gains and covariances step by step, until they are periodic.

    The period is `pattern.interval` steps. Gains and covariances are periodic if, for a whole
    period, no element of Pf differs by more than `tolerance` from the element one period earlier.
    Elements (i, j) are divided by the root of the product of the diagonal elements i and j.

    first, stop: the first step to compute, and the step before which to stop in any case.
    quiet: the number of successive steps before `first` at which Pf did not differ from one period
        earlier: 0 in the first call, then what the previous call returned.
    model: a `TwoRates` with n states.
    P0: covariance of the state one step before step 0, shape (n, n).
    filled: the arrays to fill, a `GainRows`. Their rows before `first` must have been filled.
    Returns: the number of filled rows; whether the gains are periodic; and `quiet` for the next
        call.
    """
    interval, start_interval, start_steps = pattern
    K, S, Pm, Pf = filled
    n = model.A.shape[0]
    P = P0.copy() if first == 0 else Pf[first - 1].copy()
    work = np.empty((3, n, n))
    moved = np.inf
    for k in range(first, stop):
        if k < start_steps:
            is_slow = k % start_interval == 0
        else:
            is_slow = k % interval == 0
        S[k] = riccati_step(model, P, is_slow, K[k], Pm[k], Pf[k], work)
        P = Pf[k]  # no copy: numba takes seconds to compile an assignment of slices

        if k >= start_steps + interval:
            moved = 0.0
            for i in range(n):
                for j in range(n):
                    scale = np.sqrt(abs(Pf[k, i, i] * Pf[k, j, j]))
                    if scale > 0.0:
                        moved = max(moved, abs(Pf[k, i, j] - Pf[k - interval, i, j]) / scale)
            quiet = quiet + 1 if moved <= tolerance else 0
            if quiet >= interval and (k + 1) % interval == 0:
                return k + 1, True, quiet
    return stop, False, quiet
