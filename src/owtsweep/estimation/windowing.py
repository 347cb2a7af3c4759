"""Window products and window covariances of a fixed-lag smoother, compiled."""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit


@njit
def products(first, stop, C, window, cycle, W):
    """W_k = C_k C_{k+1} ... C_{k+window-1} of four states, rows repeating after `cycle`.

    Rows first ... stop - 1 of W are filled.
    """
    rows, n = C.shape[0], 4  # a constant, so that the loops unroll
    P = np.empty((n, n))
    for k in range(first, stop):
        for i in range(n):
            for j in range(n):
                W[k, i, j] = 1.0 if i == j else 0.0
        row = k
        for _ in range(window):
            for i in range(n):
                for j in range(n):
                    total = 0.0
                    for m in range(n):
                        total += W[k, i, m] * C[row, m, j]
                    P[i, j] = total
            W[k] = P
            row += 1
            if row == rows:
                row = rows - cycle


@njit
def covariances(Pf, Pm, C, window, h, response, smoothed, coupling, first=0):
    """Smoothed covariance at the start of each window, and its coupling to the inputs' noise.

    There are four states. Row i of `smoothed` and `coupling` belongs to k = first + i; rows with
    k < window are left as they are. For the window s ... k = s + window: smoothed = P_{s|k} and
    coupling = sum over i of
    C_s ... C_{s+i-1} P_{s+i|k} h response_i', the cross-covariance of the smoothing error of s
    with what the noise of the measurements h x + v of the window does to a prediction from s.
    """
    n = 4  # a constant, so that the loops unroll
    outputs = response.shape[1]
    P = np.empty((window + 1, n, n))  # P_{s+i|k}
    inner = np.empty((n, n))
    half = np.empty((n, n))
    product = np.empty((n, n))
    vector = np.empty(n)
    for at in range(max(window - first, 0), len(smoothed)):
        k = first + at
        s = k - window
        P[window] = Pf[k]
        for i in range(window - 1, -1, -1):
            G = C[s + i]
            for a in range(n):
                for b in range(n):
                    inner[a, b] = P[i + 1, a, b] - Pm[s + i + 1, a, b]
            for a in range(n):
                for b in range(n):
                    total = 0.0
                    for m in range(n):
                        total += G[a, m] * inner[m, b]
                    half[a, b] = total
            for a in range(n):
                for b in range(n):
                    total = Pf[s + i, a, b]
                    for m in range(n):
                        total += half[a, m] * G[b, m]
                    P[i, a, b] = total
        smoothed[at] = P[0]
        coupling[at] = 0.0
        for a in range(n):
            for b in range(n):
                product[a, b] = 1.0 if a == b else 0.0
        for i in range(min(window + 1, response.shape[0])):
            for a in range(n):
                vector[a] = 0.0
                for b in range(n):
                    vector[a] += P[i, a, b] * h[b]
            for a in range(n):
                total = 0.0
                for m in range(n):
                    total += product[a, m] * vector[m]
                for b in range(outputs):
                    coupling[at, a, b] += total * response[i, b]
            if i < window:
                G = C[s + i]
                for a in range(n):
                    for b in range(n):
                        total = 0.0
                        for m in range(n):
                            total += product[a, m] * G[m, b]
                        inner[a, b] = total
                product[:, :] = inner
