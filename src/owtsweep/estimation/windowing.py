"""Compiled functions for the window of a fixed-lag smoother: its covariances and gains.

There are four states. During computations matrices are tuples of rows. The compiler keeps tuples in
registers and vectorises over them, which it may not do with small arrays that could overlap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit

_ZERO = (0.0, 0.0, 0.0, 0.0)
_NOTHING = (_ZERO, _ZERO, _ZERO, _ZERO)
_ONE = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class FilterRows(NamedTuple):
    """The arrays that a smoother takes from a filter, one row per step, shape (rows, 4, 4) each.

    `filtered` is the covariance P_k|k, `predicted` is P_k|k-1, and C are the gains of the
    Rauch-Tung-Striebel smoother.
    """

    filtered: Array
    predicted: Array
    C: Array


@njit
def schedule_row(k, rows, cycle):
    """Return the index of the gain schedule's row that serves step k.

    The schedule has `rows` rows; after them, the last `cycle` rows repeat for ever.
    """
    if k < rows:
        return k
    settled = rows - cycle
    return settled + (k - settled) % cycle


@njit
def leaving(first, stop, C, K, window, cycle, D):
    """Compute D_k = -C_k C_{k+1} ... C_{k+window-1} K_{k+window} for k = first ... stop - 1.

    D_k is written into row k of D, shape (rows, 4, 2): four states, two measurements. C, shape
    (rows, 4, 4), are the smoother's gains, and K, shape (rows, 4, 2), are the filter's. After the
    last row of C and K, the last `cycle` rows repeat.
    """
    rows = C.shape[0]
    for k in range(first, stop):
        row = schedule_row(k + window, rows, cycle)
        slow = (K[row, 0, 0], K[row, 1, 0], K[row, 2, 0], K[row, 3, 0])
        fast = (K[row, 0, 1], K[row, 1, 1], K[row, 2, 1], K[row, 3, 1])
        for step in range(k + window - 1, k - 1, -1):
            gain = _matrix(C, schedule_row(step, rows, cycle))
            slow, fast = _times(gain, slow), _times(gain, fast)
        for a in range(4):
            D[k, a, 0], D[k, a, 1] = -slow[a], -fast[a]


@njit
def covariances(rows, window, h, response, smoothed, coupling, first=0):
    """Compute smoothed covariances of the first steps of windows, and their coupling to noise.

    `rows` are `FilterRows`. A window has the steps s ... k, where s = k - window. Row i of the
    outputs `smoothed` (4, 4 each) and `coupling` (4, outputs each) belongs to k = first + i; rows
    with k < window are left as they are. smoothed = P_{s|k}, and coupling = sum over i of
    C_s ... C_{s+i-1} P_{s+i|k} h response_i'. The coupling is a cross-covariance of two errors. The
    first is the smoothing error at step s. The second is the error of a prediction from s that is
    due to the noise v of the window's measurements h x + v.
    """
    Pf, Pm, C = rows
    outputs = response.shape[1]
    inputs = min(window + 1, response.shape[0])
    row = (h[0], h[1], h[2], h[3])
    coupled = np.empty((window + 1, 4))  # P_{s+i|k} h
    for at in range(max(window - first, 0), len(smoothed)):
        k = first + at
        s = k - window
        P = _matrix(Pf, k)
        for i in range(window, -1, -1):
            if i < window:
                G = _matrix(C, s + i)
                half = _plus_product(_NOTHING, G, _minus(P, _matrix(Pm, s + i + 1)))
                P = _plus_product(_matrix(Pf, s + i), half, _transposed(G))
            for a in range(4):
                coupled[i, a] = _dot(P[a], row)
        _put(P, smoothed, at)
        coupling[at] = 0.0
        product = _ONE
        for i in range(inputs):
            vector = (coupled[i, 0], coupled[i, 1], coupled[i, 2], coupled[i, 3])
            for a in range(4):
                total = _dot(product[a], vector)
                for b in range(outputs):
                    coupling[at, a, b] += total * response[i, b]
            if i < window:
                product = _plus_product(_NOTHING, product, _matrix(C, s + i))


@njit
def _matrix(A, k):
    """Return matrix k of an array (rows, 4, 4) as a tuple of four rows."""
    return (
        (A[k, 0, 0], A[k, 0, 1], A[k, 0, 2], A[k, 0, 3]),
        (A[k, 1, 0], A[k, 1, 1], A[k, 1, 2], A[k, 1, 3]),
        (A[k, 2, 0], A[k, 2, 1], A[k, 2, 2], A[k, 2, 3]),
        (A[k, 3, 0], A[k, 3, 1], A[k, 3, 2], A[k, 3, 3]),
    )


@njit
def _put(M, A, k):
    for i in range(4):
        A[k, i, 0], A[k, i, 1], A[k, i, 2], A[k, i, 3] = M[i]


@njit
def _transposed(A):
    a, b, c, d = A
    return (
        (a[0], b[0], c[0], d[0]),
        (a[1], b[1], c[1], d[1]),
        (a[2], b[2], c[2], d[2]),
        (a[3], b[3], c[3], d[3]),
    )


@njit
def _plus_product(M, A, B):
    """Return M + A B; the products of each element are added in the order of A's columns."""
    return (
        _plus_row_product(M[0], A[0], B),
        _plus_row_product(M[1], A[1], B),
        _plus_row_product(M[2], A[2], B),
        _plus_row_product(M[3], A[3], B),
    )


@njit
def _plus_row_product(row, a, B):
    for m in range(4):
        b = B[m]
        x = a[m]
        row = (row[0] + x * b[0], row[1] + x * b[1], row[2] + x * b[2], row[3] + x * b[3])
    return row


@njit
def _minus(A, B):
    return (
        _row_minus(A[0], B[0]),
        _row_minus(A[1], B[1]),
        _row_minus(A[2], B[2]),
        _row_minus(A[3], B[3]),
    )


@njit
def _row_minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3])


@njit
def _times(A, b):
    return (_dot(A[0], b), _dot(A[1], b), _dot(A[2], b), _dot(A[3], b))


@njit
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
