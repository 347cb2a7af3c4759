"""Runs the multirate Kalman filter over some steps, on one or more groups of eight lanes.

A lane is one series of numbers along one axis.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.vectors.lanes import AHEAD, element, load, prefetch, store

#: Number of rows in which the scratch memory stores a state: two (what the predictor needs), four
#: (the whole state), or none if the state is the estimate.
PREDICTED, WHOLE, FINAL = 2, 4, 0


@njit
def row_before(k, row, rows, cycle):
    """Return the gain schedule's row for step k - 1, given the schedule's row for step k, `row`.

    The schedule has `rows` rows, one per step. After the last row, the last `cycle` rows repeat for
    ever.
    """
    if row == rows - cycle and k > row:
        return rows - 1
    return row - 1


@njit
def corrected(x0, x1, x2, x3, gains, row, column, innovation):
    """Return the state x0 ... x3 plus a gain times an innovation.

    The gain (4,) is column number `column` of matrix number `row` of `gains`, shape (rows, 4, 2).
    """
    at = 8 * row + column
    return (
        x0 + element(gains, at) * innovation,
        x1 + element(gains, at + 2) * innovation,
        x2 + element(gains, at + 4) * innovation,
        x3 + element(gains, at + 6) * innovation,
    )


@njit
def filter_steps(steps, fed, positions, chain, memory, width, late):
    """Run Algorithm 6 of Ren et al. (2019), the Kalman filter, over some steps of a chunk.

    States, and with a smoother also innovations, are stored in the scratch memory, behind the
    `window` states and innovations of the chunk before. Innovations of the position exist only at
    steps at which a position is applied; they also go to memory.output, the innovation of the
    chunk's step i to row i.

    Each step has to wait for the previous step. The sums are therefore ordered so that few
    operations lie between one state and the next: increments are computed first, then the state,
    and the term that is computed last is added last.

    Parameters
    ----------
    steps
        The `Steps` to run. A chunk is a stretch of a record whose steps are computed together.
    fed, chain, memory
        The measurements (`Fed`), the scheme (`ChainArrays`) and the working arrays (`Memory`).
    positions
        (rows, row, phase, interval). The array `rows` holds the positions that the filter takes.
        The position that is valid at the first of the steps is in row `row` and came `phase` steps
        ago. The next position comes after interval - phase steps, later positions every `interval`
        steps.
    width
        Number of rows that a stored state takes. WHOLE stores position, velocity, bias and
        acceleration. PREDICTED stores what the state adds to position and velocity at the end of
        the prediction. FINAL stores no state, but writes position and velocity to memory.output; it
        is for a chain without smoother and predictor.
    late
        An array that is read after this call, with rows numbered as those of the force. Its rows
        are prefetched. The force is prefetched too, unless there is a smoother: then the smoother
        prefetches the force.
    """
    k0, first, stop, shift = steps
    force, source = fed.force, k0 - chain.filter.input_delay - fed.base  # row of the chunk's step 0
    fixes, q, phase, M = positions
    x, scratch, output = memory.registers.x, memory.scratch, memory.output
    arrays, predictor = chain.filter, chain.predictor
    pv, pb, vb = predictor.pv, predictor.pb, predictor.vb
    pp, vp, vv = predictor.pp, predictor.vp, predictor.vv
    A, B, h, K = arrays.A, arrays.B, arrays.h, arrays.K
    a01, a02, a03, a12, a13, a22 = A[0, 1], A[0, 2], A[0, 3], A[1, 2], A[1, 3], A[2, 2]
    a00, a10, a11 = A[0, 0] - 1.0, A[1, 0], A[1, 1] - 1.0  # zero unless the IMU leans
    b0, b1 = B[0], B[1]
    h0, h2, h3 = h[0], h[2], h[3]
    rows, cycle, window = K.shape[0], arrays.cycle, arrays.window
    x0, x1, x2, x3 = load(x, 0), load(x, 1), load(x, 2), load(x, 3)
    before = load(force, source + first - 1)
    row = schedule_row(k0 + first, rows, cycle)
    applied = arrays.applied
    # fields are fetched once: in a loop numba would count references at each access
    X, r_rows, s_rows = scratch.X, scratch.r, scratch.s
    position, velocity, innovation = output.position, output.velocity, output.innovation
    for i in range(first, stop):
        now = load(force, source + i)
        prefetch(late, source + i + AHEAD)
        if window == 0:
            prefetch(force, source + i + AHEAD)
        m0 = x0 + (b0 * before + a01 * x1 + a02 * x2 + a03 * x3 + a00 * x0)
        m1 = x1 + (b1 * before + a12 * x2 + a13 * x3 + a11 * x1 + a10 * x0)
        m2 = a22 * x2
        r = now - h3 * x3 - h2 * m2 - h0 * m0
        x0, x1, x2, x3 = corrected(m0, m1, m2, x3, K, row, 1, r)
        if element(applied, row):
            s = load(fixes, q) - m0
            store(innovation, i, s)
            if window > 0:
                store(s_rows, window + i, s)
            x0, x1, x2, x3 = corrected(x0, x1, x2, x3, K, row, 0, s)
        if width == FINAL:
            store(position, i - shift, x0)
            store(velocity, i - shift, x1)
        else:
            at = width * (window + i)
            if width == WHOLE:
                store(X, at, x0)
                store(X, at + 1, x1)
                store(X, at + 2, x3)
                store(X, at + 3, x2)
            else:
                store(X, at, x0 + pv * x1 + pb * x3 + pp * x0)
                store(X, at + 1, x1 + vb * x3 + vp * x0 + vv * x1)
            if window > 0:
                store(r_rows, window + i, r)
        before = now
        phase += 1
        if phase == M:
            phase = 0
            q += 1
        row += 1
        if row == rows:
            row = rows - cycle
    store(x, 0, x0)
    store(x, 1, x1)
    store(x, 2, x2)
    store(x, 3, x3)
