"""Fixed-lag smoothing in O(1) per step, and open-loop prediction, over a chunk of eight lanes."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import schedule_row
from owtsweep.studies.hub.kernels.vector import load, store, zero


@njit
def smooth_chunk(k0, count, arrays, scratch):
    """Replace X of the steps k0 - window ... by their smoothed states (Algorithm 8).

    With e_k = x_{k|k} - x_{k|k-1} and the RTS gains C, the smoothed state is x_{k|k} + S_k, where
    S_k = C_k (e_{k+1} + S_{k+1} - W_{k+1} e_{k+1+window}). The recursion is stable backwards in
    time only, so each chunk starts it anew at its end with the window as run-up.
    """
    window, C, W = arrays.window, arrays.C, arrays.W
    rows, cycle = C.shape[0], arrays.cycle
    e, X = scratch.e, scratch.X
    s0, s1, s2, s3 = zero(), zero(), zero(), zero()
    first = max(window - k0, 0)
    for j in range(window + count - 2, first - 1, -1):
        k = k0 - window + j
        if j + 1 < count:
            row = schedule_row(k + 1, rows, cycle)
            at = 4 * (j + 1 + window)
            l0, l1, l2, l3 = load(e, at), load(e, at + 1), load(e, at + 2), load(e, at + 3)
            s0 = s0 - (
                W[row, 0, 0] * l0 + W[row, 0, 1] * l1 + W[row, 0, 2] * l2 + W[row, 0, 3] * l3
            )
            s1 = s1 - (
                W[row, 1, 0] * l0 + W[row, 1, 1] * l1 + W[row, 1, 2] * l2 + W[row, 1, 3] * l3
            )
            s2 = s2 - (
                W[row, 2, 0] * l0 + W[row, 2, 1] * l1 + W[row, 2, 2] * l2 + W[row, 2, 3] * l3
            )
            s3 = s3 - (
                W[row, 3, 0] * l0 + W[row, 3, 1] * l1 + W[row, 3, 2] * l2 + W[row, 3, 3] * l3
            )
        row = schedule_row(k, rows, cycle)
        at = 4 * (j + 1)
        y0, y1 = load(e, at) + s0, load(e, at + 1) + s1
        y2, y3 = load(e, at + 2) + s2, load(e, at + 3) + s3
        s0 = C[row, 0, 0] * y0 + C[row, 0, 1] * y1 + C[row, 0, 2] * y2 + C[row, 0, 3] * y3
        s1 = C[row, 1, 0] * y0 + C[row, 1, 1] * y1 + C[row, 1, 2] * y2 + C[row, 1, 3] * y3
        s2 = C[row, 2, 0] * y0 + C[row, 2, 1] * y1 + C[row, 2, 2] * y2 + C[row, 2, 3] * y3
        s3 = C[row, 3, 0] * y0 + C[row, 3, 1] * y1 + C[row, 3, 2] * y2 + C[row, 3, 3] * y3
        if j < count:
            at = 4 * j
            store(X, at, load(X, at) + s0)
            store(X, at + 1, load(X, at + 1) + s1)
            store(X, at + 2, load(X, at + 2) + s2)
            store(X, at + 3, load(X, at + 3) + s3)


@njit
def recall(window, registers, scratch):
    """Put the window that the last chunk left in front of this one's."""
    for row in range(4 * window):
        store(scratch.e, row, load(registers.e, row))
        store(scratch.X, row, load(registers.X, row))


@njit
def keep(count, window, registers, scratch):
    """Keep the newest `window` filtered states and corrections for the next chunk."""
    for row in range(4 * window):
        store(registers.e, row, load(scratch.e, 4 * count + row))
        store(registers.X, row, load(scratch.X, 4 * count + row))


@njit
def predict_chunk(k0, count, force, base, predictor, scratch, position, velocity):
    """Algorithm 9 for all steps of the chunk by differences of running sums of the inputs.

    The sums start anew in every chunk, so they never grow large against what they differ by.
    """
    n, T, half = predictor.steps, predictor.step, predictor.half
    pv, pb, vb = predictor.pv, predictor.pb, predictor.vb
    V, P, X = scratch.V, scratch.P, scratch.X
    v, p = zero(), zero()
    store(V, 0, v)
    store(P, 0, p)
    source = k0 - n - base
    for i in range(count + n - 1):
        u = load(force, source + i)
        p = p + T * v + half * u
        v = v + T * u
        store(P, i + 1, p)
        store(V, i + 1, v)
    span = n * T
    for i in range(count):
        x0, x1, x3 = load(X, 4 * i), load(X, 4 * i + 1), load(X, 4 * i + 3)
        v = load(V, i)
        dv = load(V, i + n) - v
        dp = load(P, i + n) - load(P, i) - span * v
        store(position, i, x0 + pv * x1 + pb * x3 + dp)
        store(velocity, i, x1 + vb * x3 + dv)
