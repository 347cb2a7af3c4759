"""Sums of squared errors of eight replicates at once, computed during the run.

A replicate is one record; each replicate has a lane, a column of the arrays. `superposed_span`
takes three groups of lanes: motion, noise of x, noise of y. The motion group is the response to the
unit displacement along the wave; the response of an axis is this response times the axis' direction
cosine. The products motion x motion, motion x noise and noise x noise are summed. The errors at
every amplitude follow from these sums. `direct_span` takes two groups, x and y, of whole series
(motion plus noise) and sums the squares of their errors.

With a predictor, estimates are made here, step by step, and never stored. Otherwise the estimates
are read from the output: the estimate of the chunk's step i from row i - shift (see `Steps`). A
chunk is a stretch of a record whose steps are computed together.

The sums have the shape (36, 8). The rows are 2 windows x 6 quantities x 3 products; the columns are
eight replicates. Window 0 is the time before settling, window 1 the time after. The quantities are
x, y, vx, vy, NEES (normalised estimation error squared) and NIS (normalised innovation squared).
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.lagging import begin_prediction, leave_prediction, predict
from owtsweep.vectors.lanes import AHEAD, element, groups, load, prefetch, rounded, store, zero


@njit
def add(sums, row, term):
    """Add eight numbers, `term`, to the row number `row` of the sums (36, 8)."""
    store(sums, row, load(sums, row) + term)


@njit
def precision_of(precision, row):
    """Return the elements pp, pv, vv of an inverse covariance of position p and velocity v.

    The elements are those of the given row of `precision`, shape (rows, 3).
    """
    at = 3 * row
    return element(precision, at), element(precision, at + 1), element(precision, at + 2)


@njit
def begin(k0, first, fed, predictor, scratch):
    """Return what the inputs add to velocity and position in the prediction at a step: dv, dp.

    dv is in m/s, dp in m; without a predictor both are zero. The inputs are the specific forces of
    the predictor's last steps. The step is number `first` of a chunk (steps that are computed
    together); the chunk begins at the record's step k0.
    """
    if predictor.steps > 0:
        return begin_prediction(k0, first, fed.force, fed.base, predictor, scratch)
    return zero(fed.force), zero(fed.force)


@njit
def estimate(i, at, row, dv, dp, force, predictor, memory):
    """Return the estimated position and velocity of the chunk's step i, then dv and dp.

    dv (m/s) and dp (m) are what the inputs (specific forces) add to velocity and position in a
    prediction: the arguments in the prediction at step i, the returned values in the prediction at
    the next step. Without a predictor dv and dp are returned unchanged. `at` is the step's row in
    `force`, `row` is its row in memory.output.
    """
    if predictor.steps > 0:
        return predict(i, at, dv, dp, force, predictor, memory.scratch.X)
    return load(memory.output.position, row), load(memory.output.velocity, row), dv, dp


@njit
def squares(px, py, vx, vy):
    """Return the squares of the position and velocity errors of both axes, each rounded once.

    Each square is used twice: in the sum of the quantity's own squares and in NEES (normalised
    estimation error squared).
    """
    return rounded(px * px), rounded(py * py), rounded(vx * vx), rounded(vy * vy)


@njit
def weighted(pp, pv, vv, position, cross, velocity):
    """Return NEES, the normalised estimation error squared, summed over both axes.

    `position` and `velocity` are sums over both axes of squared errors, `cross` is the sum of
    position error times velocity error. pp, pv and vv are elements of the inverse covariance of
    position and velocity.
    """
    return pp * position + 2.0 * pv * cross + vv * velocity


@njit
def add_axes(sums, top, direction, products):
    """Add products of motion and noise to six rows of the sums, from row `top` on: x, then y.

    The rows of an axis are motion x motion, motion x noise and noise x noise. `products` are motion
    x motion, motion x noise of x, motion x noise of y, and the squares of the noise of x and of y.
    `direction` holds the direction cosines (2,) of the motion.
    """
    cx, cy = direction[0], direction[1]
    mm, mx, my, xx, yy = products
    add(sums, top, cx * cx * mm)
    add(sums, top + 1, cx * mx)
    add(sums, top + 2, xx)
    add(sums, top + 3, cy * cy * mm)
    add(sums, top + 4, cy * my)
    add(sums, top + 5, yy)


@njit
def superposed_innovations(steps, direction, chain, output, weights, sums, top):
    """Add products of innovations, weighted as in NIS, to three rows of the sums from `top` on.

    NIS is the normalised innovation squared. The rows are motion x motion, motion x noise and noise
    x noise. `steps` are some steps of a record; steps without an innovation are skipped.
    `direction` holds the direction cosines (2,) of the motion; the other arguments are structures
    of `kernels.layout`.
    """
    cx, cy = direction[0], direction[1]
    weight, fresh = weights.innovation, weights.fresh
    rows = fresh.shape[0]
    sm, sx, sy = groups(output.innovation)
    for i in range(steps.first, steps.stop):
        row = schedule_row(steps.k0 + i, rows, chain.filter.cycle)
        if element(fresh, row):
            w = weight[row]
            s, x, y = load(sm, i), load(sx, i), load(sy, i)
            add(sums, top, w * s * s)
            add(sums, top + 1, w * s * (cx * x + cy * y))
            add(sums, top + 2, w * (x * x + y * y))


@njit
def superposed_span(steps, fed, truth, chain, memory, weights, sums, top):
    """Add products of the errors due to motion and due to noise to the sums, for some steps.

    The products go to 18 rows of the sums, from row `top` on. These rows belong to one window,
    before or after settling. The other arguments are structures of `kernels.layout`.
    """
    k0, first, stop, shift = steps
    force, base, scratch = fed.force, fed.base, memory.scratch
    position, velocity, direction = truth
    cx, cy = direction[0], direction[1]
    precision, cycle, predictor = weights.precision, chain.filter.cycle, chain.predictor
    rows = precision.shape[0]
    nought = zero(sums)
    # products of position errors, of velocity errors, and of NEES; m is motion, x and y are noise
    mm, mx, my, xx, yy = nought, nought, nought, nought, nought
    vmm, vmx, vmy, vxx, vyy = nought, nought, nought, nought, nought
    motion, both, noise = nought, nought, nought
    row = schedule_row(k0 + first, rows, cycle)
    dv, dp = begin(k0, first, fed, predictor, scratch)
    for i in range(first, stop):
        at = k0 + i - base
        x, w, dv, dp = estimate(i, at, i - shift, dv, dp, force, predictor, memory)
        prefetch(position, at + AHEAD)
        m, px, py = groups(x)
        mv, vx, vy = groups(w)
        pp, pv, vv = precision_of(precision, row)
        p, v = m - load(position, at), mv - load(velocity, at)
        mm, mx, my = mm + p * p, mx + p * px, my + p * py
        vmm, vmx, vmy = vmm + v * v, vmx + v * vx, vmy + v * vy
        pxx, pyy, wxx, wyy = squares(px, py, vx, vy)
        xx, yy, vxx, vyy = xx + pxx, yy + pyy, vxx + wxx, vyy + wyy
        wp, wv = pp * p + pv * v, pv * p + vv * v
        motion = motion + (wp * p + wv * v)
        both = both + (wp * (cx * px + cy * py) + wv * (cx * vx + cy * vy))
        noise = noise + weighted(pp, pv, vv, pxx + pyy, px * vx + py * vy, wxx + wyy)
        row += 1
        if row == rows:
            row = rows - cycle
    leave_prediction(dv, dp, scratch)
    add_axes(sums, top, direction, (mm, mx, my, xx, yy))
    add_axes(sums, top + 6, direction, (vmm, vmx, vmy, vxx, vyy))
    add(sums, top + 12, motion)
    add(sums, top + 13, both)
    add(sums, top + 14, noise)
    superposed_innovations(steps, direction, chain, memory.output, weights, sums, top + 15)


@njit
def direct_span(steps, fed, truth, chain, memory, weights, totals, top):
    """Add the squared errors of whole series (motion plus noise) to the sums, for some steps.

    The 18 rows of the sums from row `top` on belong to one window, before or after settling. Each
    quantity has three of these rows; its squares go to the third. `totals` is
    (sums, squared, keep): if `keep` is true, `squared` (steps, 8) gets the squared position error
    of each step. The other arguments are structures of `kernels.layout`.
    """
    k0, first, stop, shift = steps
    force, base, scratch = fed.force, fed.base, memory.scratch
    position, velocity, direction = truth
    sums, squared, keep = totals
    cx, cy = direction[0], direction[1]
    precision, cycle, fresh = weights.precision, chain.filter.cycle, weights.fresh
    rows, predictor = precision.shape[0], chain.predictor
    sx, sy = groups(memory.output.innovation)
    weight = weights.innovation
    t2, t5, t8 = load(sums, top + 2), load(sums, top + 5), load(sums, top + 8)
    t11, t14, t17 = load(sums, top + 11), load(sums, top + 14), load(sums, top + 17)
    row = schedule_row(k0 + first, rows, cycle)
    dv, dp = begin(k0, first, fed, predictor, scratch)
    for i in range(first, stop):
        at = k0 + i - base
        x, w, dv, dp = estimate(i, at, i - shift, dv, dp, force, predictor, memory)
        prefetch(position, at + AHEAD)
        ex, ey = groups(x)
        evx, evy = groups(w)
        pp, pv, vv = precision_of(precision, row)
        p, v = load(position, at), load(velocity, at)
        px, py = ex - cx * p, ey - cy * p
        vx, vy = evx - cx * v, evy - cy * v
        xx, yy, vxx, vyy = squares(px, py, vx, vy)
        t2, t5, t8, t11 = t2 + xx, t5 + yy, t8 + vxx, t11 + vyy
        t14 = t14 + weighted(pp, pv, vv, xx + yy, px * vx + py * vy, vxx + vyy)
        if keep:
            store(squared, k0 + i, xx + yy)
        if element(fresh, row):
            zx, zy = load(sx, i), load(sy, i)
            t17 = t17 + weight[row] * (zx * zx + zy * zy)
        row += 1
        if row == rows:
            row = rows - cycle
    leave_prediction(dv, dp, scratch)
    store(sums, top + 2, t2)
    store(sums, top + 5, t5)
    store(sums, top + 8, t8)
    store(sums, top + 11, t11)
    store(sums, top + 14, t14)
    store(sums, top + 17, t17)
