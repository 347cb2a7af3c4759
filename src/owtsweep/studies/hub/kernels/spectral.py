"""Runs the filters of SKF along x and y on eight records, and sums the squares of their errors.

A lane is one series of numbers along one axis: eight of x, then eight of y, which have gains of
their own. The state is that of `estimation.late_gains`. All arrays are given for both axes.
"""

from __future__ import annotations

from typing import NamedTuple

from owtsweep.arrays import Array
from owtsweep.compiled import njit, part
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.filtering import next_row
from owtsweep.studies.hub.kernels.layout import WIDTH, Rows, filled, rows


class SpectralArrays(NamedTuple):
    """The filters of both axes: model, gains and weights, with a state of N numbers.

    Attributes
    ----------
    A
        Transition matrix of the shaping filter as blocks along its diagonal, (2, n / 2, 2, 2).
    fast, position, velocity
        Rows (2, n) of the specific force without bias, of the position and of the velocity.
    copies, interval, delay
        Number of copies of past positions in the state; steps between two fixes; age of a fix.
    fast_gain, slow_gain
        Gains of an IMU sample, shape (2, rows, N), and of a fix, shape (2, rows / interval, N).
        After the last row, the last `interval` rows of `fast_gain`, or the last row of `slow_gain`,
        repeat.
    precision
        Elements pp, pv, vv of the inverse covariance of position and velocity, (2, rows, 3).
    weight
        Inverse of the variance of a fix's innovation, 1/m^2, shape (2, rows / interval).
    """

    A: Array
    fast: Array
    position: Array
    velocity: Array
    copies: int
    interval: int
    delay: int
    fast_gain: Array
    slow_gain: Array
    precision: Array
    weight: Array


class SpectralMemory(NamedTuple):
    """What a run keeps from one call to the next, and fills.

    Attributes
    ----------
    state
        The state; N rows with the field x.
    sums
        One row before and one after the settling time. Fields pp, vv, nees, nis: sums of squares of
        position and velocity errors, and of these weighted. The other fields are those of the
        present step, which the compiler can tell apart here: p, v (estimates), r (innovation), odd
        (the second of two sums), motion.
    squared
        Squared position error at each step, m^2, shape (steps, 8), or (0, 8) if not kept.
    estimates
        Estimated position and velocity of each step, shape (2, steps, 16), or (2, 0, 16).
    """

    state: Rows
    sums: Rows
    squared: Array
    estimates: Array


def new_memory(states: int, squared: Array, estimates: Array) -> SpectralMemory:
    """Make the memory, all zero, for a state of `states` numbers."""
    names = ("p", "v", "r", "odd", "pp", "vv", "nees", "nis", "motion")
    sums = filled([(name, 2 * WIDTH) for name in names], 2)
    return SpectralMemory(rows(states, 2 * WIDTH, "x"), sums, squared, estimates)


@part
def advance_pair(one, two, A, i, fast, t):
    """Move two states on by block i of A; add what they make of the specific force to r and odd."""
    a00, a01, a10, a11 = A[0, i, 0, 0], A[0, i, 0, 1], A[0, i, 1, 0], A[0, i, 1, 1]
    b00, b01, b10, b11 = A[1, i, 0, 0], A[1, i, 0, 1], A[1, i, 1, 0], A[1, i, 1, 1]
    f0, f1, g0, g1 = fast[0, 2 * i], fast[0, 2 * i + 1], fast[1, 2 * i], fast[1, 2 * i + 1]
    for j in range(2 * WIDTH):
        x, y = one.x[j], two.x[j]
        first = (a00 if j < WIDTH else b00) * x + (a01 if j < WIDTH else b01) * y
        second = (a10 if j < WIDTH else b10) * x + (a11 if j < WIDTH else b11) * y
        one.x[j], two.x[j] = first, second
        t.r[j] += (f0 if j < WIDTH else g0) * first
        t.odd[j] += (f1 if j < WIDTH else g1) * second


@part
def subtract_from(t, measured, at):
    """Make the innovation: r = z - (r + odd), where z is row `at` of the measurements."""
    for j in range(2 * WIDTH):
        t.r[j] = measured[at, j] - (t.r[j] + t.odd[j])


@part
def correct(x, gain, row, i, t):
    """Correct state i by its gain times the innovation: x = x + K r."""
    k, m = gain[0, row, i], gain[1, row, i]
    for j in range(2 * WIDTH):
        x.x[j] += (k if j < WIDTH else m) * t.r[j]


@part
def add_term(total, x, c, d):
    """Add a state times c (lanes of x) or d (lanes of y) to a sum."""
    for j in range(2 * WIDTH):
        total[j] += (c if j < WIDTH else d) * x.x[j]


@part
def clear(t):
    """Set a step's sums over the state to zero."""
    for j in range(2 * WIDTH):
        t.p[j] = t.v[j] = t.r[j] = t.odd[j] = 0.0


@part
def add_errors(t, cx, cy, P, row):
    """Add the squared errors of a step; motion times cx and cy is the truth along x and along y."""
    pp, pv, vv = P[0, row, 0], P[0, row, 1], P[0, row, 2]
    qq, qw, ww = P[1, row, 0], P[1, row, 1], P[1, row, 2]
    for j in range(WIDTH):
        k = WIDTH + j
        p, v = t.p[j] - cx * t.motion[j], t.v[j] - cx * t.motion[k]
        t.pp[j] += p * p
        t.vv[j] += v * v
        t.nees[j] += pp * (p * p) + 2.0 * pv * (p * v) + vv * (v * v)
        q, w = t.p[k] - cy * t.motion[j], t.v[k] - cy * t.motion[k]
        t.pp[k] += q * q
        t.vv[k] += w * w
        t.nees[k] += qq * (q * q) + 2.0 * qw * (q * w) + ww * (w * w)
        t.odd[j] = p * p + q * q


@njit
def advance(begin, stop, settled, fed, truth, c, m):
    """Run the filters over the steps begin ... stop - 1, and add their squared errors to the sums.

    Errors of steps from `settled` on count as settled. The other arguments are `Fed`, `Truth`,
    `SpectralArrays` and `SpectralMemory`.
    """
    force, base, fixes = fed.force, fed.base, fed.fixes
    motion, cx, cy = truth.motion, truth.direction[0], truth.direction[1]
    A, fast, position, velocity = c.A, c.fast, c.position, c.velocity
    fast_gain, slow_gain, weight = c.fast_gain, c.slow_gain, c.weight
    X, sums, squared, estimates = m.state, m.sums, m.squared, m.estimates
    n, N, count, last = fast.shape[1], len(X), fast_gain.shape[1], slow_gain.shape[1] - 1
    interval, copies = c.interval, c.copies
    row, since, q = schedule_row(begin, count, interval), begin % interval, begin // interval
    to_copy = (interval - (begin + c.delay) % interval) % interval
    for k in range(begin, stop):
        t = sums[0 if k < settled else 1]
        clear(t)
        for i in range(n // 2):
            advance_pair(X[2 * i], X[2 * i + 1], A, i, fast, t)
        add_term(t.r, X[n], 1.0, 1.0)
        subtract_from(t, force, k - base)
        for i in range(N):
            correct(X[i], fast_gain, row, i, t)
        if since == 0:
            number = min(q, last)
            for j in range(2 * WIDTH):
                t.r[j] = t.odd[j] = 0.0
            if copies > 0:
                add_term(t.r, X[N - 1], 1.0, 1.0)
            else:
                for i in range(n):
                    add_term(t.r, X[i], position[0, i], position[1, i])
            subtract_from(t, fixes, q)
            for i in range(N):
                correct(X[i], slow_gain, number, i, t)
            w0, w1 = weight[0, number], weight[1, number]
            for j in range(2 * WIDTH):
                t.nis[j] += (w0 if j < WIDTH else w1) * t.r[j] * t.r[j]
        for i in range(n):
            add_term(t.p, X[i], position[0, i], position[1, i])
            add_term(t.v, X[i], velocity[0, i], velocity[1, i])
        if to_copy == 0:
            for i in range(N - 1, n + 1, -1):
                X[i] = X[i - 1]
            if copies > 0:
                for j in range(2 * WIDTH):
                    X[n + 1].x[j] = t.p[j]
            to_copy = interval
        for j in range(2 * WIDTH):
            t.motion[j] = motion[k - base, j]
        if estimates.shape[1] > 0:
            for j in range(2 * WIDTH):
                estimates[0, k, j], estimates[1, k, j] = t.p[j], t.v[j]
        add_errors(t, cx, cy, c.precision, row)
        if len(squared) > 0:
            for j in range(WIDTH):
                squared[k, j] = t.odd[j]
        to_copy -= 1
        since += 1
        if since == interval:
            since, q = 0, q + 1
        row = next_row(row, count, interval)
