"""Sums of squared errors, on the fly, of eight replicates at once.

`superposed_span` takes three groups of lanes, motion, noise of x, noise of y: the motion lane is
the response to the unit displacement along the wave, of which each axis sees its direction cosine.
It sums motion x motion, motion x noise and noise x noise, from which every amplitude follows.
`direct_span` takes two groups, x and y, of whole series and sums their squares.

Where there is a predictor its estimates are made here, step by step, and never stored; else they
are read from the output, the chunk's step i from row i - shift.

Sums have the rows (2 windows, 6 quantities, 3 products), (36, 8), with the quantities x, y, vx,
vy, NEES, NIS; window 0 is the part before settling, window 1 the part after.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.lagging import begin_prediction, leave_prediction, predict
from owtsweep.studies.hub.kernels.vector import element, groups, load, store, zero


@njit
def add(sums, row, term):
    """Add a vector to a row of sums."""
    store(sums, row, load(sums, row) + term)


@njit
def precision_of(precision, row):
    """The elements pp, pv, vv of a row."""
    at = 3 * row
    return element(precision, at), element(precision, at + 1), element(precision, at + 2)


@njit
def begin(k0, first, force, base, predictor, scratch):
    """What the first step's prediction starts from; zeros where nothing is predicted."""
    if predictor.steps > 0:
        return begin_prediction(k0, first, force, base, predictor, scratch)
    return zero(force), zero(force)


@njit
def estimate(i, at, shift, dv, dp, force, predictor, scratch, position, velocity):
    """Position and velocity of the chunk's step i, and what the next step's prediction needs."""
    if predictor.steps > 0:
        return predict(i, at, dv, dp, force, predictor, scratch.X)
    return load(position, i - shift), load(velocity, i - shift), dv, dp


@njit
def superposed_innovations(k0, first, stop, top, output, direction, chain, weights, sums):
    """Add the innovations of the chunk's steps first ... stop - 1 to the rows from `top`."""
    cx, cy = direction[0], direction[1]
    weight, fresh = weights.innovation, weights.fresh
    rows = fresh.shape[0]
    sm, sx, sy = groups(output.innovation)
    for i in range(first, stop):
        row = schedule_row(k0 + i, rows, chain.filter.cycle)
        if element(fresh, row):
            w = weight[row]
            s, x, y = load(sm, i), load(sx, i), load(sy, i)
            add(sums, top, w * s * s)
            add(sums, top + 1, w * s * (cx * x + cy * y))
            add(sums, top + 2, w * (x * x + y * y))


@njit
def superposed_span(k0, first, stop, shift, top, position, velocity, force, base, scratch, output,
                    direction, chain, weights, sums):  # fmt: skip
    """Add the products of the chunk's steps first ... stop - 1 to the rows from `top`.

    `position` and `velocity` (rows, 8) hold the truth of step k in row k - base, as `force` does
    the specific force.
    """
    cx, cy = direction[0], direction[1]
    precision, cycle, predictor = weights.precision, chain.filter.cycle, chain.predictor
    rows = precision.shape[0]
    positions, velocities = output.position, output.velocity
    t0, t1, t2 = load(sums, top), load(sums, top + 1), load(sums, top + 2)
    t3, t4, t5 = load(sums, top + 3), load(sums, top + 4), load(sums, top + 5)
    t6, t7, t8 = load(sums, top + 6), load(sums, top + 7), load(sums, top + 8)
    t9, t10, t11 = load(sums, top + 9), load(sums, top + 10), load(sums, top + 11)
    t12, t13, t14 = load(sums, top + 12), load(sums, top + 13), load(sums, top + 14)
    row = schedule_row(k0 + first, rows, cycle)
    dv, dp = begin(k0, first, force, base, predictor, scratch)
    for i in range(first, stop):
        at = k0 + i - base
        x, w, dv, dp = estimate(
            i, at, shift, dv, dp, force, predictor, scratch, positions, velocities
        )
        m, px, py = groups(x)
        mv, vx, vy = groups(w)
        pp, pv, vv = precision_of(precision, row)
        p, v = m - load(position, at), mv - load(velocity, at)
        pn, vn = cx * px + cy * py, cx * vx + cy * vy
        t0 = t0 + cx * cx * p * p
        t1 = t1 + cx * p * px
        t2 = t2 + px * px
        t3 = t3 + cy * cy * p * p
        t4 = t4 + cy * p * py
        t5 = t5 + py * py
        t6 = t6 + cx * cx * v * v
        t7 = t7 + cx * v * vx
        t8 = t8 + vx * vx
        t9 = t9 + cy * cy * v * v
        t10 = t10 + cy * v * vy
        t11 = t11 + vy * vy
        t12 = t12 + (pp * p * p + 2.0 * pv * p * v + vv * v * v)
        t13 = t13 + (pp * p * pn + pv * (p * vn + v * pn) + vv * v * vn)
        t14 = t14 + (
            pp * (px * px + py * py) + 2.0 * pv * (px * vx + py * vy) + vv * (vx * vx + vy * vy)
        )
        row += 1
        if row == rows:
            row = rows - cycle
    leave_prediction(dv, dp, scratch)
    store(sums, top, t0)
    store(sums, top + 1, t1)
    store(sums, top + 2, t2)
    store(sums, top + 3, t3)
    store(sums, top + 4, t4)
    store(sums, top + 5, t5)
    store(sums, top + 6, t6)
    store(sums, top + 7, t7)
    store(sums, top + 8, t8)
    store(sums, top + 9, t9)
    store(sums, top + 10, t10)
    store(sums, top + 11, t11)
    store(sums, top + 12, t12)
    store(sums, top + 13, t13)
    store(sums, top + 14, t14)
    superposed_innovations(k0, first, stop, top + 15, output, direction, chain, weights, sums)


@njit
def direct_span(k0, first, stop, shift, top, position, velocity, force, base, scratch, output,
                direction, chain, weights, sums, keep, squared):  # fmt: skip
    """Add the squared errors (product 2) of the chunk's steps first ... stop - 1.

    Truth and force lie as in `superposed_span`; where they are to be kept, `squared` (steps, 8)
    takes the squared errors of the position.
    """
    cx, cy = direction[0], direction[1]
    precision, cycle, fresh = weights.precision, chain.filter.cycle, weights.fresh
    rows, predictor = precision.shape[0], chain.predictor
    positions, velocities = output.position, output.velocity
    sx, sy = groups(output.innovation)
    weight = weights.innovation
    t2, t5, t8 = load(sums, top + 2), load(sums, top + 5), load(sums, top + 8)
    t11, t14, t17 = load(sums, top + 11), load(sums, top + 14), load(sums, top + 17)
    row = schedule_row(k0 + first, rows, cycle)
    dv, dp = begin(k0, first, force, base, predictor, scratch)
    for i in range(first, stop):
        at = k0 + i - base
        x, w, dv, dp = estimate(
            i, at, shift, dv, dp, force, predictor, scratch, positions, velocities
        )
        ex, ey = groups(x)
        evx, evy = groups(w)
        pp, pv, vv = precision_of(precision, row)
        p, v = load(position, at), load(velocity, at)
        px, py = ex - cx * p, ey - cy * p
        vx, vy = evx - cx * v, evy - cy * v
        t2 = t2 + px * px
        t5 = t5 + py * py
        t8 = t8 + vx * vx
        t11 = t11 + vy * vy
        t14 = t14 + (
            pp * (px * px + py * py) + 2.0 * pv * (px * vx + py * vy) + vv * (vx * vx + vy * vy)
        )
        if keep:
            store(squared, k0 + i, px * px + py * py)
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
