"""Turns the filter's state into an online estimator's estimate: fixed-lag smoother, predictor."""

from __future__ import annotations

from owtsweep.compiled import njit, part
from owtsweep.estimation.windowing import FilterRows, covariances
from owtsweep.studies.hub.kernels.horizon import put, take
from owtsweep.studies.hub.kernels.online_layout import PICK, ROW, STEP
from owtsweep.studies.hub.kernels.predicting import add_input, predict
from owtsweep.studies.hub.kernels.smoothing import (
    add_correction,
    add_force,
    add_position,
    carry_back,
)


@njit
def smoother_gain(A, filtered, predicted, work, C):
    """Compute the smoother's gain C = P_{k|k} A' P_{k+1|k}^-1 by Gaussian elimination.

    `filtered` is P_{k|k}, `predicted` is P_{k+1|k}; all matrices are (n, n). `work` is memory for
    at least two. There is no pivoting, since covariances do not need it.
    """
    n = len(A)
    M, X = work[0], work[1]
    put(M, 0, 0, predicted)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for m in range(n):
                total += A[i, m] * filtered[m, j]
            X[i, j] = total
    for c in range(n):
        for i in range(c + 1, n):
            factor = M[i, c] / M[c, c]
            for j in range(c, n):
                M[i, j] -= factor * M[c, j]
            for j in range(n):
                X[i, j] -= factor * X[c, j]
    for i in range(n - 1, -1, -1):
        for j in range(n):
            total = X[i, j]
            for m in range(i + 1, n):
                total -= M[i, m] * C[j, m]
            C[j, i] = total / M[i, i]


@njit
def output(f, m, state, covariance):
    """Smooth and predict (Algorithms 8 and 9 of Ren et al. 2019); write the present estimate.

    x, y, v_x, v_y are written to `state` (4,), the covariance of position and velocity along an
    axis to `covariance` (2, 2). Without a predictor, the filter's state is the estimate.
    """
    row, k, window = m.counter[ROW], m.counter[STEP], f.window
    if not f.predicts:
        write(m.steps[row], state)
        take(covariance, m.P, 0, 0)
        return
    if window > 0 and k > 0:
        smoother_gain(f.A, m.Pf[row - 1], m.Pm[row], m.work, m.C[row - 1])
    x, S, sums = m.estimate[0], m.back[0], m.inputs[0]
    clear(x)
    if k >= window:  # until then the smoother's register is not full
        clear(S)
        for j in range(row, row - window, -1):
            add_position(S, m.steps[j], m.K, j)
            add_force(S, m.steps[j], m.K, j)
            carry_back(S, m.C, j - 1)
        add_correction(x, m.steps[row - window])
        add_correction(x, S)
    for axis in range(2):
        sums.p[axis] = sums.v[axis] = 0.0
    for j in range(row - f.predictor.steps, row):
        add_input(sums, m.force[j], f.predictor.step, f.predictor.half, f.predictor.lean)
    predict(x, sums, m.force, row, f.predictor)
    write(x, state)
    output_covariance(f, m, covariance)


@part
def clear(x):
    """Set a state to zero."""
    for axis in range(2):
        x.p[axis] = x.v[axis] = x.a[axis] = x.b[axis] = 0.0


@part
def write(x, state):
    """Write a state's positions and velocities to `state` (4,)."""
    for axis in range(2):
        state[axis], state[2 + axis] = x.p[axis], x.v[axis]


@njit
def output_covariance(f, m, covariance):
    """Write the covariance (2, 2) of predicted position and velocity, equal for both axes.

    `hub.chain` uses the same formula for the batch engine.
    """
    row, window = m.counter[ROW], f.window
    if f.delay + window == 0:
        take(covariance, m.P, 0, 0)
        return
    smoothed, coupling = m.smoothed, m.coupling
    if m.counter[STEP] >= window:
        begin = row - window
        rows = FilterRows(m.Pf[begin : row + 1], m.Pm[begin : row + 1], m.C[begin : row + 1])
        covariances(rows, window, f.h, f.response, smoothed, coupling)
        P, cross = smoothed[window], coupling[window]
    else:
        P, cross = f.P0, m.no_coupling
    for a in range(2):
        for b in range(2):
            total = f.added[a, b]
            for i in range(3):
                total += f.ahead[a, i] * cross[PICK[i], b] + f.ahead[b, i] * cross[PICK[i], a]
                for j in range(3):
                    total += f.ahead[a, i] * P[PICK[i], PICK[j]] * f.ahead[b, j]
            covariance[a, b] = total
