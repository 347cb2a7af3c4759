"""Fixed-lag smoothing in O(1) per step, and open-loop prediction, over a chunk."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.filtering import PREDICTED, WHOLE, corrected, row_before
from owtsweep.vectors.lanes import element, load, prefetch, store, zero


@njit
def combined(y0, y1, y2, y3, C, at):
    """The sum of a state's components times the four elements of C from `at` on."""
    a, b, c, d = element(C, at), element(C, at + 1), element(C, at + 2), element(C, at + 3)
    return a * y0 + b * y1 + c * y2 + d * y3


@njit
def carried_back(y0, y1, y2, y3, C, row):
    """C y: what a correction y of one step means for the step before."""
    return (
        combined(y0, y1, y2, y3, C, 16 * row),
        combined(y0, y1, y2, y3, C, 16 * row + 4),
        combined(y0, y1, y2, y3, C, 16 * row + 8),
        combined(y0, y1, y2, y3, C, 16 * row + 12),
    )


@njit
def given_and_taken(K, D, row, r, leaving):
    """A step's correction by the specific force, and by the one that leaves the window."""
    at = 8 * row + 1
    return (
        element(K, at) * r + element(D, at) * leaving,
        element(K, at + 2) * r + element(D, at + 2) * leaving,
        element(K, at + 4) * r + element(D, at + 4) * leaving,
        element(K, at + 6) * r + element(D, at + 6) * leaving,
    )


@njit
def add_smoothing(X, j, width, s0, s1, s2, s3, predictor):
    """Add the smoothing correction s0 ... s3 to the rows of filtered state j."""
    at = width * j
    if width == WHOLE:
        store(X, at, load(X, at) + s0)
        store(X, at + 1, load(X, at + 1) + s1)
        store(X, at + 2, load(X, at + 2) + s3)
        store(X, at + 3, load(X, at + 3) + s2)
    else:
        store(X, at, load(X, at) + s0 + predictor.pv * s1 + predictor.pb * s3)
        store(X, at + 1, load(X, at + 1) + s1 + predictor.vb * s3)


@njit
def smooth_chunk(k0, count, chain, width, window_rows, force, source):
    """Replace the states X of the steps k0 - window ... by their smoothed states (Algorithm 8).

    With innovations i_k, e_k = K_k i_k = x_{k|k} - x_{k|k-1} and the RTS gains C, the smoothed
    state is x_{k|k} + S_k, where S_k = C_k (e_{k+1} + S_{k+1} + D_{k+1} i_{k+1+window}). The
    recursion is stable backwards in time only. Each chunk therefore starts it anew, one window
    beyond its last state, and in that window no innovation leaves.
    window_rows: the states X, of `width` rows each as the filter wrote them, and the innovations r
    of the force and s of the position; see `Scratch`.
    Meanwhile the force of the next chunk is prefetched, row source + count + i, because the filter
    reads it faster than memory delivers it.
    """
    X, r, s = window_rows
    arrays, predictor = chain.filter, chain.predictor
    window, C, D = arrays.window, arrays.C, arrays.D
    rows, cycle = C.shape[0], arrays.cycle
    K, applied = arrays.K, arrays.applied
    s0, s1, s2, s3 = zero(X), zero(X), zero(X), zero(X)
    last, first = count - 1, max(window - k0, 0)
    row = schedule_row(k0 + last, rows, cycle)
    for j in range(window + last, max(first, last), -1):
        y0, y1, y2, y3 = corrected(s0, s1, s2, s3, K, row, 1, load(r, j))
        if element(applied, row):
            y0, y1, y2, y3 = corrected(y0, y1, y2, y3, K, row, 0, load(s, j))
        row = row_before(k0 - window + j, row, rows, cycle)
        s0, s1, s2, s3 = carried_back(y0, y1, y2, y3, C, row)
    if first <= last:
        add_smoothing(X, last, width, s0, s1, s2, s3, predictor)
    far = schedule_row(k0 + last, rows, cycle)
    for j in range(last, first, -1):
        e0, e1, e2, e3 = given_and_taken(K, D, row, load(r, j), load(r, j + window))
        y0, y1, y2, y3 = s0 + e0, s1 + e1, s2 + e2, s3 + e3
        if element(applied, row):
            y0, y1, y2, y3 = corrected(y0, y1, y2, y3, K, row, 0, load(s, j))
        if element(applied, far):
            y0, y1, y2, y3 = corrected(y0, y1, y2, y3, D, row, 0, load(s, j + window))
        far = row_before(k0 + j, far, rows, cycle)
        row = row_before(k0 - window + j, row, rows, cycle)
        s0, s1, s2, s3 = carried_back(y0, y1, y2, y3, C, row)
        add_smoothing(X, j - 1, width, s0, s1, s2, s3, predictor)
        prefetch(force, source + j + count)


@njit
def recall(window, width, registers, scratch):
    """Copy the window that the last chunk kept to the front of the scratch."""
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
    """What the inputs before step `first` add to the predicted velocity and position."""
    dv, dp = load(scratch.inputs, 0), load(scratch.inputs, 1)
    if first == 0:
        n, T, half = predictor.steps, predictor.step, predictor.half
        dv, dp = zero(force), zero(force)
        for row in range(k0 - n - base, k0 - base):
            u = load(force, row)
            dp = dp + T * dv + half * u
            dv = dv + T * u
    return dv, dp


@njit
def predict(i, at, dv, dp, force, predictor, X):
    """Algorithm 9 at the chunk's step i: position, velocity, and the next step's dv and dp.

    X holds the contribution of the states. That of the inputs is a moving sum, dv and dp: the
    newest input, row `at` of the force, enters and the oldest leaves. The sum is computed anew in
    every chunk, so that rounding errors do not accumulate.
    """
    n, T, half = predictor.steps, predictor.step, predictor.half
    x, w = load(X, PREDICTED * i) + dp, load(X, PREDICTED * i + 1) + dv
    new, old = load(force, at), load(force, at - n)
    dp = dp + (T * dv + half * new - (half + n * T * T) * old)
    dv = dv + T * (new - old)
    return x, w, dv, dp


@njit
def leave_prediction(dv, dp, scratch):
    """Keep the sums with which `begin_prediction` continues within the chunk."""
    store(scratch.inputs, 0, dv)
    store(scratch.inputs, 1, dp)
