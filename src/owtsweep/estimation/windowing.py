"""Compiled functions for a smoother with a fixed lag: its gains and covariances.

There are four states. During computations a matrix is a tuple of four rows, because the compiler
keeps tuples in the processor's registers. Small arrays are not kept in registers, since they might
overlap in memory.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit, part

_ZERO = (0.0, 0.0, 0.0, 0.0)
_NOTHING = (_ZERO, _ZERO, _ZERO, _ZERO)
_ONE = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class FilterRows(NamedTuple):
    """The arrays from which a smoother's covariances are computed, shape (rows, 4, 4) each.

    filtered, predicted: covariances of the state after and before the measurements of a step.
    C: gains of the Rauch-Tung-Striebel smoother.
    """

    filtered: Array
    predicted: Array
    C: Array


@part
def schedule_row(k, rows, cycle):
    """Return the row of a schedule of `rows` rows, of which the last `cycle` repeat, for step k."""
    if k < rows:
        return k
    settled = rows - cycle
    return settled + (k - settled) % cycle


@part
def next_row(row, rows, cycle):
    """Return the schedule's row of the next step, if `row` is that of a step."""
    return row + 1 if row + 1 < rows else rows - cycle


@part
def row_before(k, row, rows, cycle):
    """Return the schedule's row of step k - 1, if `row` is that of step k."""
    return rows - 1 if row == rows - cycle and k > row else row - 1


@njit
def leaving(C, K, window, cycle, D):
    """Compute D_k = -C_k C_{k+1} ... C_{k+window-1} K_{k+window} for all rows k.

    D_k times the innovations of step k + window removes their contribution from the smoothed state
    of step k.

    C, K: gains of the smoother, shape (rows, 4, 4), and of the filter, shape (rows, 4, 2).
    window: the lag of the smoother in steps.
    cycle: number of rows, at the end of C and of K, that repeat for ever.
    D: array of shape (rows, 4, 2), into whose row k the result D_k is written.
    """
    rows = C.shape[0]
    for k in range(rows):
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
    """Compute covariances of smoothed states, and their coupling to errors of a prediction.

    A smoother estimates the state of step s = k - window from the measurements up to step k. Row i
    of both outputs belongs to k = first + i. Rows with k < window are left unchanged, because s
    would be negative.

    rows: covariances of the filter and gains C of the smoother, as `FilterRows`.
    window: the lag of the smoother in steps.
    h: row (4,) of the measurement matrix, for measurements h x + v of the state x with noise v.
    response: shape (steps, outputs): row i is the effect of the noise v of step s + i on the
        prediction from step s on.
    smoothed: filled, shape (rows, 4, 4): the covariances P_{s|k} of the smoothed states.
    coupling: filled, shape (rows, 4, outputs): the cross-covariances between the error of the
        smoothed state and the error of the prediction due to v. They are the sum over i of C_s ...
        C_{s+i-1} P_{s+i|k} h response_i'.
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


@part
def _matrix(A, k):
    return (
        (A[k, 0, 0], A[k, 0, 1], A[k, 0, 2], A[k, 0, 3]),
        (A[k, 1, 0], A[k, 1, 1], A[k, 1, 2], A[k, 1, 3]),
        (A[k, 2, 0], A[k, 2, 1], A[k, 2, 2], A[k, 2, 3]),
        (A[k, 3, 0], A[k, 3, 1], A[k, 3, 2], A[k, 3, 3]),
    )


@part
def _put(M, A, k):
    for i in range(4):
        A[k, i, 0], A[k, i, 1], A[k, i, 2], A[k, i, 3] = M[i]


@part
def _transposed(A):
    a, b, c, d = A
    return (
        (a[0], b[0], c[0], d[0]),
        (a[1], b[1], c[1], d[1]),
        (a[2], b[2], c[2], d[2]),
        (a[3], b[3], c[3], d[3]),
    )


@part
def _plus_product(M, A, B):
    """Return M + A B for matrices as tuples of four rows.

    The products for an element of A B are added to the element of M in the order of A's columns.
    """
    return (
        _plus_row_product(M[0], A[0], B),
        _plus_row_product(M[1], A[1], B),
        _plus_row_product(M[2], A[2], B),
        _plus_row_product(M[3], A[3], B),
    )


@part
def _plus_row_product(row, a, B):
    for m in range(4):
        b = B[m]
        x = a[m]
        row = (row[0] + x * b[0], row[1] + x * b[1], row[2] + x * b[2], row[3] + x * b[3])
    return row


@part
def _minus(A, B):
    return (
        _row_minus(A[0], B[0]),
        _row_minus(A[1], B[1]),
        _row_minus(A[2], B[2]),
        _row_minus(A[3], B[3]),
    )


@part
def _row_minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3])


@part
def _times(A, b):
    return (_dot(A[0], b), _dot(A[1], b), _dot(A[2], b), _dot(A[3], b))


@part
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
