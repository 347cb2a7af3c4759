"""The compiled recursion of a linear filter whose gains settle."""

from __future__ import annotations

from owtsweep.compiled import njit


@njit
def recur(early, settled, x):
    """Replace each row of x by x[k] = F[k] x[k-1] + x[k], from the first row, before which is zero.

    early: the transposed matrices F of the first steps, shape (early steps, N, N).
    settled: the transposed matrix F of all later steps, shape (N, N).
    x: what enters at each step, shape (steps, N); overwritten by the result.
    """
    steps, N = x.shape
    for k in range(1, steps):
        transposed = early[k] if k < len(early) else settled
        for j in range(N):
            # Columns of F one after the other: the compiler can then add several rows at once.
            before = x[k - 1, j]
            column = transposed[j]
            for i in range(N):
                x[k, i] += column[i] * before
