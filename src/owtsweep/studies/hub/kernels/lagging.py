"""Smooths with a fixed lag, in O(1) per step, and predicts without measurements.

The functions work on chunks. A chunk is a stretch of a record whose steps are computed together.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.filtering import PREDICTED, WHOLE, corrected, row_before
from owtsweep.vectors.lanes import element, load, prefetch, store, zero


@njit
def combined(y0, y1, y2, y3, C, at):
    """Return c0 y0 + c1 y1 + c2 y2 + c3 y3, where c0 ... c3 are elements of the array C.

    The elements have the flat indices at ... at + 3.
    """
    a, b, c, d = element(C, at), element(C, at + 1), element(C, at + 2), element(C, at + 3)
    return a * y0 + b * y1 + c * y2 + d * y3


@njit
def carried_back(y0, y1, y2, y3, C, row):
    """Return the product of C[row], one of the smoother's gains (rows, 4, 4), and y = (y0 ... y3).

    If y is a correction of one step's state, the product is the correction of the state one step
    before.
    """
    return (
        combined(y0, y1, y2, y3, C, 16 * row),
        combined(y0, y1, y2, y3, C, 16 * row + 4),
        combined(y0, y1, y2, y3, C, 16 * row + 8),
        combined(y0, y1, y2, y3, C, 16 * row + 12),
    )


@njit
def given_and_taken(K, D, row, r, leaving):
    """Return how the specific force corrects one step's state in the smoother's recursion.

    The correction (four numbers) is the gain K times the step's own innovation r, plus the gain D
    times the innovation that leaves the smoother's window (`leaving`). Both are innovations of the
    specific force. The gains are column 1 of matrix number `row` of K and D, shape (rows, 4, 2)
    each.
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
    """Add the smoothing correction s0 ... s3 to the filtered state number j in X.

    In X a state takes `width` rows, WHOLE or PREDICTED (see `filter_steps`). With PREDICTED, the
    rows get what the correction adds to the predicted position and velocity. `predictor` is
    `PredictorArrays`.
    """
    at = width * j
    if width == WHOLE:
        store(X, at, load(X, at) + s0)
        store(X, at + 1, load(X, at + 1) + s1)
        store(X, at + 2, load(X, at + 2) + s3)
        store(X, at + 3, load(X, at + 3) + s2)
    else:
        p = predictor
        store(X, at, load(X, at) + s0 + p.pv * s1 + p.pb * s3 + p.pp * s0)
        store(X, at + 1, load(X, at + 1) + s1 + p.vb * s3 + p.vp * s0 + p.vv * s1)


@njit
def smooth_chunk(k0, count, chain, width, window_rows, force, source):
    """Replace `count` filtered states by smoothed states (Algorithm 8 of Ren et al. 2019).

    With the innovations i_k, the corrections e_k = K_k i_k and the smoother's gains C and D, the
    smoothed state is x_{k|k} + S_k, where S_k = C_k (e_{k+1} + S_{k+1} + D_{k+1} i_{k+1+window}).
    This recursion is stable backwards in time only. Each chunk (steps computed together) therefore
    starts the recursion anew, one window after the chunk's last state; inside this window the term
    with D is absent.

    The force of the next chunk is prefetched meanwhile, because the filter reads the force faster
    than memory delivers it.

    Parameters
    ----------
    k0
        First step of the chunk. The first of the states belongs to step k0 - window.
    chain
        The scheme, `ChainArrays`.
    width
        Number of rows that a state takes, WHOLE or PREDICTED (see `filter_steps`).
    window_rows
        The states X, the innovations r of the specific force and s of the position, as in
        `Scratch`.
    force, source
        The specific force, and its row that belongs to step k0.
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
    """Copy the previous chunk's last `window` states and innovations to the front of the scratch.

    `keep` left them in the registers. A state takes `width` rows. A chunk is a stretch of a record
    whose steps are computed together.
    """
    for row in range(window):
        store(scratch.r, row, load(registers.r, row))
        store(scratch.s, row, load(registers.s, row))
    for row in range(width * window):
        store(scratch.X, row, load(registers.X, row))


@njit
def keep(count, window, width, registers, scratch):
    """Copy a chunk's last `window` filtered states and innovations to the registers, for `recall`.

    A chunk is a stretch of a record whose steps are computed together. The chunk has `count` steps;
    a state takes `width` rows.
    """
    for row in range(window):
        store(registers.r, row, load(scratch.r, count + row))
        store(registers.s, row, load(scratch.s, count + row))
    for row in range(width * window):
        store(registers.X, row, load(scratch.X, width * count + row))


@njit
def begin_prediction(k0, first, force, base, predictor, scratch):
    """Return what the inputs add to velocity and position in the prediction at a step: dv, dp.

    dv is in m/s, dp in m. The inputs are the specific forces of the predictor's last steps. The
    step is number `first` of a chunk (steps that are computed together); the chunk begins at the
    record's step k0. At the chunk's first step, dv and dp are computed anew; later they are what
    `leave_prediction` has kept in the scratch. The force of step k is in row k - base of `force`.
    """
    dv, dp = load(scratch.inputs, 0), load(scratch.inputs, 1)
    if first == 0:
        n, T, half, lean = predictor.steps, predictor.step, predictor.half, predictor.lean
        dv, dp = zero(force), zero(force)
        for row in range(k0 - n - base, k0 - base):
            u = load(force, row)
            leaning = lean.vp * dp + lean.vv * dv + lean.vu * u
            dp = dp + T * dv + half * u + (lean.pp * dp + lean.pv * dv)
            dv = dv + T * u + leaning
    return dv, dp


@njit
def predict(i, at, dv, dp, force, predictor, X):
    """Predict position and velocity at the chunk's step i (Algorithm 9 of Ren et al. 2019).

    Return position (m), velocity (m/s), and dv and dp for the next step. X holds what the filter's
    states add to the predicted position and velocity. dv and dp are what the inputs, the specific
    forces of the predictor's last steps, add to velocity and position. For the next step, the
    newest input, row `at` of the force, is included and the oldest input left out. dv and dp are
    computed anew in every chunk (a stretch of a record), so that rounding errors do not accumulate.
    """
    n, T, half, lean = predictor.steps, predictor.step, predictor.half, predictor.lean
    x, w = load(X, PREDICTED * i) + dp, load(X, PREDICTED * i + 1) + dv
    new, old = load(force, at), load(force, at - n)
    if predictor.linear:
        x = x + (predictor.new_p * new - predictor.first_p * old)
        w = w + (predictor.new_v * new - predictor.first_v * old)
    leaning = lean.vp * dp + lean.vv * dv + lean.vu * new - predictor.old_v * old
    dp = dp + (T * dv + half * new - predictor.old_p * old) + (lean.pp * dp + lean.pv * dv)
    dv = dv + T * (new - old) + leaning
    return x, w, dv, dp


@njit
def leave_prediction(dv, dp, scratch):
    """Keep in the scratch what the inputs add to velocity, dv (m/s), and to position, dp (m).

    `begin_prediction` continues with dv and dp at a later step of the same chunk (a stretch of a
    record). The inputs are specific forces.
    """
    store(scratch.inputs, 0, dv)
    store(scratch.inputs, 1, dp)
