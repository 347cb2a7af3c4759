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
from owtsweep.vectors.lanes import AHEAD, element, groups, load, prefetch, rounded, store, zero


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
def squares(px, py, vx, vy):
    """Squared errors of both axes: each is added to its own sum and weighed in NEES."""
    return rounded(px * px), rounded(py * py), rounded(vx * vx), rounded(vy * vy)


@njit
def weighted(pp, pv, vv, position, cross, velocity):
    """NEES of both axes from sums of squares and of products of position and velocity."""
    return pp * position + 2.0 * pv * cross + vv * velocity


@njit
def add_axes(sums, top, cx, cy, mm, mx, my, xx, yy):
    """Add what the motion and the noise have given to the rows of x and y."""
    add(sums, top, cx * cx * mm)
    add(sums, top + 1, cx * mx)
    add(sums, top + 2, xx)
    add(sums, top + 3, cy * cy * mm)
    add(sums, top + 4, cy * my)
    add(sums, top + 5, yy)


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
    nought = zero(sums)
    # products of position errors, of velocity errors, and NEES: m motion, x and y noise
    mm, mx, my, xx, yy = nought, nought, nought, nought, nought
    vmm, vmx, vmy, vxx, vyy = nought, nought, nought, nought, nought
    motion, both, noise = nought, nought, nought
    row = schedule_row(k0 + first, rows, cycle)
    dv, dp = begin(k0, first, force, base, predictor, scratch)
    for i in range(first, stop):
        at = k0 + i - base
        x, w, dv, dp = estimate(
            i, at, shift, dv, dp, force, predictor, scratch, positions, velocities
        )
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
    add_axes(sums, top, cx, cy, mm, mx, my, xx, yy)
    add_axes(sums, top + 6, cx, cy, vmm, vmx, vmy, vxx, vyy)
    add(sums, top + 12, motion)
    add(sums, top + 13, both)
    add(sums, top + 14, noise)
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
