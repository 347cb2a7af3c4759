"""Smooths with a fixed lag, in O(1) per step, and predicts open-loop, over a chunk of steps."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.filtering import PREDICTED, WHOLE, corrected, row_before
from owtsweep.vectors.lanes import element, load, prefetch, store, zero


@njit
def combined(y0, y1, y2, y3, C, at):
    """Return the sum of four components y0 ... y3 times the four elements of C from `at` on."""
    a, b, c, d = element(C, at), element(C, at + 1), element(C, at + 2), element(C, at + 3)
    return a * y0 + b * y1 + c * y2 + d * y3


@njit
def carried_back(y0, y1, y2, y3, C, row):
    """Return the matrix C[row] (4, 4) times y.

    If y is a correction of one step's state, the result is the correction of the previous step's.
    """
    return (
        combined(y0, y1, y2, y3, C, 16 * row),
        combined(y0, y1, y2, y3, C, 16 * row + 4),
        combined(y0, y1, y2, y3, C, 16 * row + 8),
        combined(y0, y1, y2, y3, C, 16 * row + 12),
    )


@njit
def given_and_taken(K, D, row, r, leaving):
    """Return a step's correction by the specific force, for the smoother's recursion.

    The correction is the gain K times the step's own innovation r, plus the gain D times the
    innovation that leaves the smoother's window. `row` is a row of K and D.
    """
    at = 8 * row + 1
    return (
        element(K, at) * r + element(D, at) * leaving,
        element(K, at + 2) * r + element(D, at + 2) * leaving,
        element(K, at + 4) * r + element(D, at + 4) * leaving,
        element(K, at + 6) * r + element(D, at + 6) * leaving,
    )


@njit
def add_smoothing(X, j, width, s0, s1, s2, s3, predictor):
    """Add the smoothing correction s0 ... s3 to the rows of the filtered state number j in X.

    A state has `width` rows: WHOLE or PREDICTED.
    """
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
    """Replace `count` filtered states by smoothed states (Algorithm 8 of Ren et al. 2019).

    The chunk begins at step k0; the states belong to the steps k0 - window to
    k0 - window + count - 1. With the innovations i_k, the corrections e_k = K_k i_k and the
    smoother's gains C, the smoothed state is x_{k|k} + S_k, where
    S_k = C_k (e_{k+1} + S_{k+1} + D_{k+1} i_{k+1+window}). This recursion is stable backwards in
    time only. Each chunk therefore starts it anew, one window after its last state; inside this
    window the term with D is absent.

    `window_rows` are the states X, of `width` rows each, the innovations r of the specific force,
    and the innovations s of the position; see `Scratch`. Meanwhile the force of the next chunk is
    prefetched, because the filter reads it faster than memory delivers it; `source` is the row of
    the present chunk's first step in the force.
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
    """Copy the `window` states and innovations that the last chunk kept to the scratch's front."""
    for row in range(window):
        store(scratch.r, row, load(registers.r, row))
        store(scratch.s, row, load(registers.s, row))
    for row in range(width * window):
        store(scratch.X, row, load(registers.X, row))


@njit
def keep(count, window, width, registers, scratch):
    """Copy the newest `window` filtered states and innovations to registers for the next chunk."""
    for row in range(window):
        store(registers.r, row, load(scratch.r, count + row))
        store(registers.s, row, load(scratch.s, count + row))
    for row in range(width * window):
        store(registers.X, row, load(scratch.X, width * count + row))


@njit
def begin_prediction(k0, first, force, base, predictor, scratch):
    """Return what the inputs add to the predicted velocity and position of step `first`.

    At the start of a chunk, which begins at step k0, the sums over the inputs are computed anew.
    Later they are those that `leave_prediction` kept.
    """
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
    """Predict position and velocity at the chunk's step i (Algorithm 9 of Ren et al. 2019).

    Return position, velocity, and the sums dv and dp of the next step. X holds what the states add
    to position and velocity. What the inputs add are moving sums, dp and dv: the newest input, row
    `at` of the force, enters and the oldest leaves. The sums are computed anew in every chunk, so
    that rounding errors do not accumulate.
    """
    n, T, half = predictor.steps, predictor.step, predictor.half
    x, w = load(X, PREDICTED * i) + dp, load(X, PREDICTED * i + 1) + dv
    new, old = load(force, at), load(force, at - n)
    dp = dp + (T * dv + half * new - (half + n * T * T) * old)
    dv = dv + T * (new - old)
    return x, w, dv, dp


@njit
def leave_prediction(dv, dp, scratch):
    """Keep the sums over the inputs, with which `begin_prediction` continues within the chunk."""
    store(scratch.inputs, 0, dv)
    store(scratch.inputs, 1, dp)
