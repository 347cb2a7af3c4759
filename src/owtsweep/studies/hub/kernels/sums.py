"""Sums of squared errors, on the fly.

`superposed` takes lanes [motion of each replicate | noise of each replicate and axis]: the motion
lane is the response to the unit displacement along the wave, of which each axis sees its direction
cosine. It sums motion x motion, motion x noise and noise x noise, from which every amplitude
follows. `direct` takes lanes [replicate and axis] of whole series and sums their squares.

Sums have the shape (2 windows, 6, 3 products, replicates) with the quantities x, y, vx, vy, NEES,
NIS; window 0 is the part before settling, window 1 the part after.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import schedule_row


@njit
def superposed(k0, count, settled, position, velocity, direction, precision, innovation_weight,
               fresh, cycle, memory, sums):  # fmt: skip
    """Add the chunk's products; `position` and `velocity` (steps, replicates) are the truth.

    `precision` (rows, 3) is the inverse of the (p, v) covariance of one axis, `innovation_weight`
    (rows,) the inverse of the innovation's variance, `fresh` (rows,) where there is one.
    """
    replicates = position.shape[1]
    cx, cy = direction[0], direction[1]
    rows = precision.shape[0]
    for i in range(count):
        k = k0 + i
        row = schedule_row(k, rows, cycle)
        w = 0 if k < settled else 1
        pp, pv, vv = precision[row, 0], precision[row, 1], precision[row, 2]
        ep, ev = memory.position[i], memory.velocity[i]
        for r in range(replicates):
            x, y = replicates + 2 * r, replicates + 2 * r + 1
            p = ep[r] - position[k, r]
            v = ev[r] - velocity[k, r]
            px, py, vx, vy = ep[x], ep[y], ev[x], ev[y]
            pn, vn = cx * px + cy * py, cx * vx + cy * vy
            sums[w, 0, 0, r] += cx * cx * p * p
            sums[w, 0, 1, r] += cx * p * px
            sums[w, 0, 2, r] += px * px
            sums[w, 1, 0, r] += cy * cy * p * p
            sums[w, 1, 1, r] += cy * p * py
            sums[w, 1, 2, r] += py * py
            sums[w, 2, 0, r] += cx * cx * v * v
            sums[w, 2, 1, r] += cx * v * vx
            sums[w, 2, 2, r] += vx * vx
            sums[w, 3, 0, r] += cy * cy * v * v
            sums[w, 3, 1, r] += cy * v * vy
            sums[w, 3, 2, r] += vy * vy
            sums[w, 4, 0, r] += pp * p * p + 2.0 * pv * p * v + vv * v * v
            sums[w, 4, 1, r] += pp * p * pn + pv * (p * vn + v * pn) + vv * v * vn
            sums[w, 4, 2, r] += (
                pp * (px * px + py * py) + 2.0 * pv * (px * vx + py * vy) + vv * (vx * vx + vy * vy)
            )
        if fresh[row]:
            weight = innovation_weight[row]
            s = memory.innovation[i]
            for r in range(replicates):
                x, y = s[replicates + 2 * r], s[replicates + 2 * r + 1]
                sums[w, 5, 0, r] += weight * s[r] * s[r]
                sums[w, 5, 1, r] += weight * s[r] * (cx * x + cy * y)
                sums[w, 5, 2, r] += weight * (x * x + y * y)


@njit
def direct(k0, count, settled, position, velocity, direction, precision, innovation_weight,
           fresh, cycle, memory, sums, squared):  # fmt: skip
    """Add the chunk's squared errors (product 2); `squared` (steps or 0, replicates) keeps them."""
    replicates = position.shape[1]
    cx, cy = direction[0], direction[1]
    rows = precision.shape[0]
    for i in range(count):
        k = k0 + i
        row = schedule_row(k, rows, cycle)
        w = 0 if k < settled else 1
        pp, pv, vv = precision[row, 0], precision[row, 1], precision[row, 2]
        ep, ev = memory.position[i], memory.velocity[i]
        for r in range(replicates):
            px = ep[2 * r] - cx * position[k, r]
            py = ep[2 * r + 1] - cy * position[k, r]
            vx = ev[2 * r] - cx * velocity[k, r]
            vy = ev[2 * r + 1] - cy * velocity[k, r]
            sums[w, 0, 2, r] += px * px
            sums[w, 1, 2, r] += py * py
            sums[w, 2, 2, r] += vx * vx
            sums[w, 3, 2, r] += vy * vy
            sums[w, 4, 2, r] += (
                pp * (px * px + py * py) + 2.0 * pv * (px * vx + py * vy) + vv * (vx * vx + vy * vy)
            )
            if squared.shape[0] > 0:
                squared[k, r] = px * px + py * py
        if fresh[row]:
            weight = innovation_weight[row]
            s = memory.innovation[i]
            for r in range(replicates):
                x, y = s[2 * r], s[2 * r + 1]
                sums[w, 5, 2, r] += weight * (x * x + y * y)
