"""Fixed-lag smoothing in O(1) per step, and open-loop prediction, over a chunk."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import PREDICTED, WHOLE, row_before, schedule_row
from owtsweep.studies.hub.kernels.vector import load, prefetch, store, zero


@njit
def smooth_chunk(k0, count, arrays, predictor, width, X, r, s, e, after, force, source):
    """Replace X of the steps k0 - window ... by their smoothed states (Algorithm 8).

    With e_k = x_{k|k} - x_{k|k-1} and the RTS gains C, the smoothed state is x_{k|k} + S_k, where
    S_k = C_k (e_{k+1} + S_{k+1} - W_{k+1} e_{k+1+window}). The recursion is stable backwards in
    time only, so each chunk starts it anew at its end with the window as run-up. e = K (s, r) is
    made again of the innovations: that is cheaper than to fetch it. A ring keeps it until it leaves
    the window.
    States have `width` rows, as the filter left them. Unless they are WHOLE, what the predictor
    takes of the smoothed ones is left in the first two.
    Row source + i of `after` is asked for on the way, for each of the chunk's steps k0 + i, and the
    row of `force` that lies a chunk further: there is more time to fetch them here than in filter
    and MHE, which work through their rows faster than memory gives them.
    """
    window, C, W = arrays.window, arrays.C, arrays.W
    rows, cycle = C.shape[0], arrays.cycle
    K, applied = arrays.K, arrays.applied
    pv, pb, vb = predictor.pv, predictor.pb, predictor.vb
    nothing = zero(X)
    for at in range(4 * window):
        store(e, at, nothing)
    s0, s1, s2, s3 = nothing, nothing, nothing, nothing
    row = schedule_row(k0 + count - 1, rows, cycle)
    slot = (window + count - 1) % window
    for j in range(window + count - 2, max(window - k0, 0) - 1, -1):
        at = 4 * slot
        l0, l1, l2, l3 = load(e, at), load(e, at + 1), load(e, at + 2), load(e, at + 3)
        seen = load(r, j + 1)
        e0, e1 = K[row, 0, 1] * seen, K[row, 1, 1] * seen
        e2, e3 = K[row, 2, 1] * seen, K[row, 3, 1] * seen
        if applied[row]:
            seen = load(s, j + 1)
            e0, e1 = e0 + K[row, 0, 0] * seen, e1 + K[row, 1, 0] * seen
            e2, e3 = e2 + K[row, 2, 0] * seen, e3 + K[row, 3, 0] * seen
        store(e, at, e0)
        store(e, at + 1, e1)
        store(e, at + 2, e2)
        store(e, at + 3, e3)
        # what does not wait for the step before comes first
        e0 = e0 - W[row, 0, 0] * l0 - W[row, 0, 1] * l1 - W[row, 0, 2] * l2 - W[row, 0, 3] * l3
        e1 = e1 - W[row, 1, 0] * l0 - W[row, 1, 1] * l1 - W[row, 1, 2] * l2 - W[row, 1, 3] * l3
        e2 = e2 - W[row, 2, 0] * l0 - W[row, 2, 1] * l1 - W[row, 2, 2] * l2 - W[row, 2, 3] * l3
        e3 = e3 - W[row, 3, 0] * l0 - W[row, 3, 1] * l1 - W[row, 3, 2] * l2 - W[row, 3, 3] * l3
        y0, y1, y2, y3 = e0 + s0, e1 + s1, e2 + s2, e3 + s3
        row = row_before(k0 - window + j + 1, row, rows, cycle)
        slot = slot - 1 if slot > 0 else window - 1
        s0 = C[row, 0, 0] * y0 + C[row, 0, 1] * y1 + C[row, 0, 2] * y2 + C[row, 0, 3] * y3
        s1 = C[row, 1, 0] * y0 + C[row, 1, 1] * y1 + C[row, 1, 2] * y2 + C[row, 1, 3] * y3
        s2 = C[row, 2, 0] * y0 + C[row, 2, 1] * y1 + C[row, 2, 2] * y2 + C[row, 2, 3] * y3
        s3 = C[row, 3, 0] * y0 + C[row, 3, 1] * y1 + C[row, 3, 2] * y2 + C[row, 3, 3] * y3
        if j < count:
            prefetch(after, source + j)
            prefetch(force, source + j + count)
            at = width * j
            x0, x1, x3 = load(X, at) + s0, load(X, at + 1) + s1, load(X, at + 2) + s3
            if width == WHOLE:
                store(X, at, x0)
                store(X, at + 1, x1)
                store(X, at + 2, x3)
                store(X, at + 3, load(X, at + 3) + s2)
            else:
                store(X, at, x0 + pv * x1 + pb * x3)
                store(X, at + 1, x1 + vb * x3)


@njit
def carry_states(count, predictor, X):
    """Leave what the predictor takes of unsmoothed states in the first two of their rows."""
    pv, pb, vb = predictor.pv, predictor.pb, predictor.vb
    for at in range(0, PREDICTED * count, PREDICTED):
        x0, x1, x3 = load(X, at), load(X, at + 1), load(X, at + 2)
        store(X, at, x0 + pv * x1 + pb * x3)
        store(X, at + 1, x1 + vb * x3)


@njit
def recall(window, width, registers, scratch):
    """Put the window that the last chunk left in front of this one's."""
    for row in range(window):
        store(scratch.r, row, load(registers.r, row))
        store(scratch.s, row, load(registers.s, row))
    for row in range(width * window):
        store(scratch.X, row, load(registers.X, row))


@njit
def keep(count, window, width, registers, scratch):
    """Keep the newest `window` filtered states and innovations for the next chunk."""
    for row in range(window):
        store(registers.r, row, load(scratch.r, count + row))
        store(registers.s, row, load(scratch.s, count + row))
    for row in range(width * window):
        store(registers.X, row, load(scratch.X, width * count + row))


@njit
def begin_prediction(k0, first, force, base, predictor, scratch):
    """The running sums before the chunk's step `first`, and where they and the oldest stand."""
    n, T, half = predictor.steps, predictor.step, predictor.half
    V, P = scratch.V, scratch.P
    if first > 0:
        newest = (first + n - 1) % (n + 1)
        return load(V, newest), load(P, newest), newest, first % (n + 1)
    v, p = zero(force), zero(force)
    store(V, 0, v)
    store(P, 0, p)
    for i in range(n - 1):
        u = load(force, k0 - n - base + i)
        p = p + T * v + half * u
        v = v + T * u
        store(P, i + 1, p)
        store(V, i + 1, v)
    return v, p, n - 1, 0


@njit
def predict(i, u, v, p, newest, oldest, predictor, scratch):
    """Algorithm 9 at the chunk's step i with the newest input u: position and velocity.

    The states' part lies in X, two of three rows. The inputs' is a difference of running sums,
    which a ring of predictor.steps + 1 rows holds; they start anew in every chunk, so they never
    grow large against what they differ by. They come first, as `begin_prediction` gives them.
    """
    n, T, half = predictor.steps, predictor.step, predictor.half
    V, P, X = scratch.V, scratch.P, scratch.X
    p = p + T * v + half * u
    v = v + T * u
    newest = newest + 1 if newest < n else 0
    v0, p0 = load(V, oldest), load(P, oldest)
    store(P, newest, p)
    store(V, newest, v)
    oldest = oldest + 1 if oldest < n else 0
    dv = v - v0
    dp = p - p0 - n * T * v0
    return v, p, newest, oldest, load(X, PREDICTED * i) + dp, load(X, PREDICTED * i + 1) + dv
