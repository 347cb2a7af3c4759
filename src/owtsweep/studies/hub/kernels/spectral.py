"""Runs the filter of one axis of SKF on eight series, and sums the squares of its errors.

A lane is one series of numbers along one axis; the kernel runs eight lanes side by side. The state
is that of `estimation.late_gains`.
"""

from __future__ import annotations

from typing import NamedTuple

from owtsweep.arrays import Array
from owtsweep.compiled import njit
from owtsweep.estimation.windowing import schedule_row
from owtsweep.vectors.lanes import AHEAD, borrowed, element, load, prefetch, store, zero


class SpectralArrays(NamedTuple):
    """The filter of one axis: model, gains and weights, with a state of N numbers.

    Attributes
    ----------
    A
        Transition matrix of the shaping filter as blocks along its diagonal, shape (n / 2, 2, 2).
    fast, position, velocity
        Rows (n,) of the specific force without bias, of the position and of the velocity.
    copies, interval, delay
        Number of copies of past positions in the state; steps between two fixes; age of a fix.
    fast_gain, slow_gain
        Gains of an IMU sample, shape (rows, N), and of a fix, shape (rows / interval, N). After the
        last row, the last `interval` rows of `fast_gain`, or the last row of `slow_gain`, repeat.
    precision
        Elements pp, pv, vv of the inverse covariance of position and velocity, shape (rows, 3).
    weight
        Inverse of the variance of a fix's innovation, 1/m^2, shape (rows / interval,).
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


class SpectralSpan(NamedTuple):
    """The measurements and the true motion of eight series along an axis, for some steps.

    Attributes
    ----------
    base
        The number of the step in row 0.
    force, position, velocity
        Specific force (m/s^2), and along the wave the true displacement (m) and velocity (m/s) of
        the motion of unit amplitude; a tuple of one array (rows, 8) each.
    fixes
        All position fixes of the record, m, a tuple of one array (fixes, 8).
    share
        The axis' motion per motion along the wave at unit amplitude.
    """

    base: int
    force: tuple[Array]
    position: tuple[Array]
    velocity: tuple[Array]
    fixes: tuple[Array]
    share: float


class SpectralMemory(NamedTuple):
    """What a run keeps from one call to the next, and fills; each field is a tuple of one array.

    Attributes
    ----------
    state
        The state, shape (N, 8).
    sums
        Sums over the steps before (rows 0 to 3) and after the settling time (rows 4 to 7), shape
        (8, 8): squares of position and velocity errors, NEES, NIS.
    squared
        Sums over the axes of the squared position error at each step, m^2, shape (steps, 8), or
        (0, 8) if they are not kept.
    estimates
        Estimated position and velocity of each step, shape (2 steps, 8): two rows per step. Or
        (0, 8) if they are not kept.
    """

    state: tuple[Array]
    sums: tuple[Array]
    squared: tuple[Array]
    estimates: tuple[Array]


@njit
def advance(begin, stop, settled, span, arrays, memory):
    """Run the filter over the steps begin ... stop - 1, and add its squared errors to the sums.

    Errors of steps from `settled` on count as settled. The other arguments are `SpectralSpan`,
    `SpectralArrays` and `SpectralMemory`.
    """
    keep, show = len(memory.squared[0]) > 0, len(memory.estimates[0]) > 0
    fed, m, c = borrowed(span), borrowed(memory), borrowed(arrays)
    A, fast, p_row, v_row = c.A, c.fast, c.position, c.velocity
    fast_gain, slow_gain, precision, weight = c.fast_gain, c.slow_gain, c.precision, c.weight
    interval, copies, share, base = c.interval, c.copies, fed.share, fed.base
    force, fixes, truth, speed = fed.force, fed.fixes, fed.position, fed.velocity
    x, sums, squared, estimates = m.state, m.sums, m.squared, m.estimates
    n, N, rows, last = len(p_row), fast_gain.shape[1], len(fast_gain), len(slow_gain) - 1
    row, since, q = schedule_row(begin, rows, interval), begin % interval, begin // interval
    to_copy = (interval - (begin + c.delay) % interval) % interval
    for k in range(begin, stop):
        # two sums, so that an addition need not wait for the one before
        even, odd = load(x, n), zero(x)
        for i in range(0, n, 2):
            at = 2 * i
            one, two = load(x, i), load(x, i + 1)
            first = element(A, at) * one + element(A, at + 1) * two
            second = element(A, at + 2) * one + element(A, at + 3) * two
            store(x, i, first)
            store(x, i + 1, second)
            even = even + element(fast, i) * first
            odd = odd + element(fast, i + 1) * second
        prefetch(force, k - base + AHEAD)
        residual = load(force, k - base) - (even + odd)
        at = row * N
        for i in range(N):
            store(x, i, load(x, i) + element(fast_gain, at + i) * residual)
        top = 0 if k < settled else 4
        if since == 0:
            number = min(q, last)
            if copies > 0:
                expected = load(x, N - 1)
            else:
                expected = zero(x)
                for i in range(n):
                    expected = expected + element(p_row, i) * load(x, i)
            innovation = load(fixes, q) - expected
            at = number * N
            for i in range(N):
                store(x, i, load(x, i) + element(slow_gain, at + i) * innovation)
            w = element(weight, number)
            store(sums, top + 3, load(sums, top + 3) + w * innovation * innovation)
        p, v, p_odd, v_odd = zero(x), zero(x), zero(x), zero(x)
        for i in range(0, n, 2):
            one, two = load(x, i), load(x, i + 1)
            p, p_odd = p + element(p_row, i) * one, p_odd + element(p_row, i + 1) * two
            v, v_odd = v + element(v_row, i) * one, v_odd + element(v_row, i + 1) * two
        p, v = p + p_odd, v + v_odd
        if to_copy == 0:
            for i in range(N - 1, n + 1, -1):
                store(x, i, load(x, i - 1))
            if copies > 0:
                store(x, n + 1, p)
            to_copy = interval
        if show:
            store(estimates, 2 * k, p)
            store(estimates, 2 * k + 1, v)
        p = p - share * load(truth, k - base)
        v = v - share * load(speed, k - base)
        at = 3 * row
        pp, pv, vv = element(precision, at), element(precision, at + 1), element(precision, at + 2)
        square = p * p
        store(sums, top, load(sums, top) + square)
        store(sums, top + 1, load(sums, top + 1) + v * v)
        nees = pp * square + 2.0 * pv * (p * v) + vv * (v * v)
        store(sums, top + 2, load(sums, top + 2) + nees)
        if keep:
            store(squared, k, load(squared, k) + square)
        to_copy -= 1
        since += 1
        if since == interval:
            since = 0
            q += 1
        row += 1
        if row == rows:
            row = rows - interval
