"""Turns the filter's state into an online estimator's estimate: fixed-lag smoother, predictor."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import FilterRows, covariances
from owtsweep.studies.hub.kernels.online_layout import PICK, ROW, STEP
from owtsweep.studies.hub.kernels.window import put, take


@njit
def smoother_gain(A, filtered, predicted, work, C):
    """Compute the smoother's gain C = P_{k|k} A' P_{k+1|k}^-1 by Gaussian elimination.

    `filtered` is P_{k|k}, `predicted` is P_{k+1|k}; all matrices are (n, n). The gain is written to
    C. `work` is memory for at least two matrices. There is no pivoting, since covariances do not
    need pivoting.
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

    x, y, v_x, v_y are written to `state` (4,). The covariance of position and velocity along an
    axis is written to `covariance` (2, 2). Without a predictor, the filter's state is the estimate.
    `f` is `FilterSettings`, `m` is `OnlineRegisters`.
    """
    row, k, window = m.counter[ROW], m.counter[STEP], f.window
    if not f.predicts:
        for axis in range(2):
            state[axis], state[2 + axis] = m.x[0, axis], m.x[1, axis]
        take(covariance, m.P, 0, 0)
        return
    if window > 0 and k > 0:
        smoother_gain(f.A, m.Pf[row - 1], m.Pm[row], m.work, m.C[row - 1])
    A, B, N = f.input_A, f.input_B, f.input_next
    for axis in range(2):
        s0 = s1 = s2 = s3 = 0.0
        if k >= window:
            for j in range(row - 1, row - 1 - window, -1):
                C = m.C[j]
                y0, y1 = m.e[j + 1, 0, axis] + s0, m.e[j + 1, 1, axis] + s1
                y2, y3 = m.e[j + 1, 2, axis] + s2, m.e[j + 1, 3, axis] + s3
                s0 = C[0, 0] * y0 + C[0, 1] * y1 + C[0, 2] * y2 + C[0, 3] * y3
                s1 = C[1, 0] * y0 + C[1, 1] * y1 + C[1, 2] * y2 + C[1, 3] * y3
                s2 = C[2, 0] * y0 + C[2, 1] * y1 + C[2, 2] * y2 + C[2, 3] * y3
                s3 = C[3, 0] * y0 + C[3, 1] * y1 + C[3, 2] * y2 + C[3, 3] * y3
            X = m.X[row - window]
            p, v, b = X[0, axis] + s0, X[1, axis] + s1, X[3, axis] + s3
        else:
            p = v = b = 0.0  # the smoother's register is not full yet
        for j in range(row - f.delay - window, row):
            u, after = m.force[j, axis], m.force[j + 1, axis]
            p, v = (
                p + A[0, 1] * v + A[0, 2] * b + B[0] * u + (A[0, 0] - 1.0) * p + N[0] * after,
                v + A[1, 2] * b + B[1] * u + (A[1, 0] * p + (A[1, 1] - 1.0) * v) + N[1] * after,
            )
        state[axis], state[2 + axis] = p, v
    output_covariance(f, m, covariance)


@njit
def output_covariance(f, m, covariance):
    """Write the covariance of predicted position and velocity to `covariance` (2, 2).

    The covariance is equal for both axes. `hub.chain` uses the same formula for the batch engine.
    `f` is `FilterSettings`, `m` is `OnlineRegisters`.
    """
    row, window = m.counter[ROW], f.window
    if f.delay + window == 0:
        take(covariance, m.P, 0, 0)
        return
    smoothed, coupling = m.smoothed, m.coupling
    if m.counter[STEP] >= window:
        begin = row - window
        rows = FilterRows(m.Pf[begin : row + 1], m.Pm[begin : row + 1], m.C[begin : row + 1])
        covariances(rows, window, f.fast, f.response, smoothed, coupling)
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
