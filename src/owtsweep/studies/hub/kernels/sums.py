"""Sums of squared errors of eight replicates at once, computed during the run.

In a superposed run a replicate has three lanes: motion (the response to the unit displacement along
the wave), noise of x, noise of y. An axis responds to motion as the motion's lane does, times the
axis' direction cosine. So the products motion x motion, motion x noise and noise x noise give the
errors at every amplitude. In a direct run a replicate has two lanes, x and y of motion plus noise;
its squares count as noise x noise. Lanes of one kind stand side by side.

NEES is e' P^-1 e for the errors e of position and velocity, NIS is s^2 / S for the innovation s;
both are sums over the axes. `batch.new_sums` explains the row t of the sums.
"""

from __future__ import annotations

from owtsweep.compiled import njit, part
from owtsweep.estimation.windowing import next_row, schedule_row
from owtsweep.studies.hub.kernels.layout import WIDTH


@part
def copy_estimate(t, x, motion, at):
    """Copy a step's estimates and true motion into the row t."""
    for i in range(len(t.p)):
        t.p[i], t.v[i] = x.p[i], x.v[i]
    for i in range(len(t.motion)):
        t.motion[i] = motion[at, i]


@part
def add_products(t, cx, cy, P, row):
    """Add the products of the errors from motion and of those from noise, for one step.

    cx and cy are the wave's direction cosines. P (rows, 3) are `Weights.precision`.
    """
    pp, pv, vv = P[row, 0], P[row, 1], P[row, 2]
    for i in range(WIDTH):
        p, v = t.p[i] - t.motion[i], t.v[i] - t.motion[WIDTH + i]
        px, py, vx, vy = t.p[WIDTH + i], t.p[2 * WIDTH + i], t.v[WIDTH + i], t.v[2 * WIDTH + i]
        pxx, pyy, vxx, vyy = px * px, py * py, vx * vx, vy * vy
        wp, wv = pp * p + pv * v, pv * p + vv * v
        t.mm[i] += p * p
        t.mx[i] += p * px
        t.my[i] += p * py
        t.xx[i] += pxx
        t.yy[i] += pyy
        t.vmm[i] += v * v
        t.vmx[i] += v * vx
        t.vmy[i] += v * vy
        t.vxx[i] += vxx
        t.vyy[i] += vyy
        t.nmm[i] += wp * p + wv * v
        t.nmx[i] += wp * (cx * px + cy * py) + wv * (cx * vx + cy * vy)
        t.nxx[i] += pp * (pxx + pyy) + 2.0 * pv * (px * vx + py * vy) + vv * (vxx + vyy)


@part
def add_squares(t, cx, cy, P, row):
    """Add the squared errors of whole series, for one step; see `add_products`."""
    pp, pv, vv = P[row, 0], P[row, 1], P[row, 2]
    for i in range(WIDTH):
        p, v = t.motion[i], t.motion[WIDTH + i]
        px, py = t.p[i] - cx * p, t.p[WIDTH + i] - cy * p
        vx, vy = t.v[i] - cx * v, t.v[WIDTH + i] - cy * v
        pxx, pyy, vxx, vyy = px * px, py * py, vx * vx, vy * vy
        t.xx[i] += pxx
        t.yy[i] += pyy
        t.vxx[i] += vxx
        t.vyy[i] += vyy
        t.nxx[i] += pp * (pxx + pyy) + 2.0 * pv * (px * vx + py * vy) + vv * (vxx + vyy)
        t.square[i] = pxx + pyy


@part
def add_innovations(t, x, w, cx, cy):
    """Add the products of the innovations in the row x, times the inverse w of their variance."""
    for i in range(len(t.p)):
        t.p[i] = x.s[i]
    if len(t.p) == 3 * WIDTH:
        for i in range(WIDTH):
            s, sx, sy = t.p[i], t.p[WIDTH + i], t.p[2 * WIDTH + i]
            t.imm[i] += w * s * s
            t.imx[i] += w * s * (cx * sx + cy * sy)
            t.ixx[i] += w * (sx * sx + sy * sy)
    else:
        for i in range(WIDTH):
            sx, sy = t.p[i], t.p[WIDTH + i]
            t.ixx[i] += w * (sx * sx + sy * sy)


@part
def sum_chunk(k0, count, settled, fed, truth, f, weights, steps, sums, squared):
    """Add the errors of the `count` steps from step k0 on, whose estimates are in `steps`.

    Errors from step `settled` on go to the second row of `sums`. `squared`, shape (steps, WIDTH) or
    empty, gets the squared position errors of a direct run.
    """
    motion, direction = truth
    cx, cy = direction[0], direction[1]
    P, weight, fresh = weights
    rows, cycle, window, keeps = P.shape[0], f.cycle, f.window, len(squared) > 0
    row = schedule_row(k0, rows, cycle)
    for i in range(count):
        x, t = steps[1 + i], sums[0 if k0 + i < settled else 1]
        copy_estimate(t, x, motion, k0 + i - fed.base)
        if len(t.p) == 3 * WIDTH:
            add_products(t, cx, cy, P, row)
        else:
            add_squares(t, cx, cy, P, row)
            if keeps:
                for j in range(WIDTH):
                    squared[k0 + i, j] = t.square[j]
        if fresh[row]:
            add_innovations(t, steps[1 + window + i], weight[row], cx, cy)
        row = next_row(row, rows, cycle)


@njit
def add_spectral_errors(early, found, motion, cosine, sums, squared):
    """Add the squared errors of SKF along one axis, of which the first `early` are not settled.

    `found` are `LateEstimates` of eight records; the others are as in `spectral_batch.AxisRun`.
    """
    for k in range(len(motion)):
        total = sums[0 if k < early else 1]
        P, V, C = found.covariance[k, 0, 0], found.covariance[k, 1, 1], found.covariance[k, 0, 1]
        factor = 1.0 / (P * V - C * C)
        pp, pv, vv = factor * V, -factor * C, factor * P  # the inverse
        for j in range(WIDTH):
            p = found.outputs[k, 0, j] - cosine * motion[k, j]
            v = found.outputs[k, 1, j] - cosine * motion[k, WIDTH + j]
            total[0, j] += p * p
            total[1, j] += v * v
            total[2, j] += pp * (p * p) + 2.0 * pv * (p * v) + vv * (v * v)
            if len(squared) > 0:
                squared[k, j] += p * p
