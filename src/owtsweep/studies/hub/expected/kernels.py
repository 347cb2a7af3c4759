"""Compiled loops of the expected engine: sinusoids, the chain's answers, and the squared errors.

One call takes two groups of eight lanes through a whole stretch of the record: sinusoids are made
just before the chain needs them, in buffers that stay in the cache, and errors are squared as soon
as there are some. Phasors have their cosines in group 0 and their sines in group 1; else each group
holds eight sines of its own.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.runs import estimates
from owtsweep.vectors import WIDTH
from owtsweep.vectors.lanes import borrowed, groups, load, store


@njit
def advance(k0, stop, judged, every, lanes, tolerance, chunk, settled, cycle, waves, state, moving,
            phasor, truth, lead, force, wave, fixes, chain, registers, scratch, output, sums,
            ring):  # fmt: skip
    """Take two groups on from step k0 until their answer repeats, or to the step `stop`.

    From the first whole chunk up to `judged` on it is judged every so many steps. `state` holds the
    step of the buffers' row 0 and the one up to which they are filled; `moving` tells whether there
    is any force; `sums` and `ring` are those of `add_squares`.

    Returns
    -------
    int, bool
        The step that was reached, and whether the answer repeats there.
    """
    room = force[0].shape[0]
    while k0 < stop:
        count = min(chunk, stop - k0)
        if moving:
            if k0 + count - state[0] > room:
                _move(force, k0 - lead - state[0], state[1] - state[0])
                if truth:
                    _move(wave, k0 - lead - state[0], state[1] - state[0])
                state[0] = k0 - lead
            make_waves(state[1], k0 + count, state[0], waves, phasor, truth, force, wave)
            state[1] = k0 + count
        else:
            state[0] = k0 - lead  # zeros, whichever step they belong to
        estimates(k0, count, force, state[0], fixes, chain, registers, scratch, output)
        add_squares(k0, count, settled, cycle, output.position, output.velocity, state[0], wave,
                    waves.rate, phasor, truth, sums, ring)  # fmt: skip
        k0 += count
        if k0 >= judged:
            if repeats(k0 // cycle, lanes, tolerance, ring):
                return k0, True
            judged = k0 + every
    return k0, False


@njit
def repeats(newest, lanes, tolerance, ring):
    """Whether the sums of all whole cycles in the ring are the same, in each of so many lanes.

    `newest` is the number of the cycle that is not whole.
    """
    slots = ring.shape[0] // 4
    for row in range(4):
        for lane in range(max(min(lanes - WIDTH * (row % 2), WIDTH), 0)):
            least, most = np.inf, -np.inf
            for slot in range(slots):
                if slot != newest % slots:
                    value = ring[4 * slot + row, lane]
                    # what is no number never repeats
                    if not value >= 0.0:
                        return False
                    least, most = min(least, value), max(most, value)
            if not most - least <= tolerance * most:
                return False
    return True


@njit
def _move(buffers, first, stop):
    """Rows first ... stop - 1 to the beginning of each buffer."""
    rows = borrowed(buffers)
    for i in range(first, stop):
        store(rows, i - first, load(rows, i))


@njit
def make_waves(k, stop, base, waves, phasor, keep, force, wave):
    """Fill the rows of steps k ... stop - 1 of force (and wave, if kept), step `base` in row 0.

    The sinusoids are turned on from step to step, and begin anew with every block, so that rounding
    does not add up; in between `now` keeps them.
    """
    u0, u1 = groups(borrowed(force))
    w0, w1 = groups(borrowed(wave))
    starts, now = borrowed((waves.starts,)), borrowed((waves.now,))
    fixed = borrowed((waves.turn_gain,))
    turn0, turn1 = load(fixed, 0), load(fixed, 1)  # cosine and sine of group 0's angle
    turn2, turn3 = load(fixed, 2), load(fixed, 3)  # those of group 1's
    gain0, gain1 = load(fixed, 4), load(fixed, 5)
    while k < stop:
        block = k // waves.block
        if k == block * waves.block:
            for i in range(4):
                store(now, i, load(starts, 4 * block + i))
        until = min((block + 1) * waves.block, stop)
        c, s = load(now, 0), load(now, 1)
        if phasor:
            for row in range(k - base, until - base):
                store(u0, row, gain0 * c)
                store(u1, row, gain0 * s)
                if keep:
                    store(w0, row, c)
                    store(w1, row, s)
                c, s = c * turn0 - s * turn1, c * turn1 + s * turn0
        else:
            d, t = load(now, 2), load(now, 3)
            for row in range(k - base, until - base):
                store(u0, row, gain0 * s)
                store(u1, row, gain1 * t)
                c, s = c * turn0 - s * turn1, c * turn1 + s * turn0
                d, t = d * turn2 - t * turn3, d * turn3 + t * turn2
            store(now, 2, d)
            store(now, 3, t)
        store(now, 0, c)
        store(now, 1, s)
        k = until


@njit
def add_squares(k0, count, settled, cycle, position, velocity, base, wave, rate, phasor, truth,
                sums, ring):  # fmt: skip
    """Add squared errors to the sums of the record and of the cycle.

    `sums` has the rows (2 parts of the record, 2 measures, 2 groups), `ring` (slots, 2, 2): the
    sums of the newest cycles, cycle q in slot q % slots. With `truth` the wave is what the position
    should be, and its `rate` the velocity. A phasor's squares are added in group 0.
    """
    p0, p1 = groups(borrowed(position))
    v0, v1 = groups(borrowed(velocity))
    w0, w1 = groups(borrowed(wave))
    omega = load(borrowed((rate,)), 0)
    total, newest = borrowed((sums,)), borrowed((ring,))
    slots = ring.shape[0] // 4
    k, end = k0, k0 + count
    while k < end:
        stop = min((k // cycle + 1) * cycle, end)
        if k < settled:
            stop = min(stop, settled)
        own = 0 if k < settled else 4
        slot = 4 * ((k // cycle) % slots)
        if k % cycle == 0:
            for i in range(slot, slot + 4):
                store(newest, i, 0.0 * omega)
        a0, a1 = load(total, own), load(total, own + 1)
        b0, b1 = load(total, own + 2), load(total, own + 3)
        c0, c1 = load(newest, slot), load(newest, slot + 1)
        d0, d1 = load(newest, slot + 2), load(newest, slot + 3)
        if phasor:
            for i in range(k - k0, stop - k0):
                p, q, v, w = load(p0, i), load(p1, i), load(v0, i), load(v1, i)
                if truth:
                    c, s = load(w0, k0 + i - base), load(w1, k0 + i - base)
                    p, q, v, w = p - c, q - s, v + omega * s, w - omega * c
                a, b = p * p + q * q, v * v + w * w
                a0, b0, c0, d0 = a0 + a, b0 + b, c0 + a, d0 + b
        else:
            for i in range(k - k0, stop - k0):
                p, q, v, w = load(p0, i), load(p1, i), load(v0, i), load(v1, i)
                p, q, v, w = p * p, q * q, v * v, w * w
                a0, a1, b0, b1 = a0 + p, a1 + q, b0 + v, b1 + w
                c0, c1, d0, d1 = c0 + p, c1 + q, d0 + v, d1 + w
        store(total, own, a0)
        store(total, own + 1, a1)
        store(total, own + 2, b0)
        store(total, own + 3, b1)
        store(newest, slot, c0)
        store(newest, slot + 1, c1)
        store(newest, slot + 2, d0)
        store(newest, slot + 3, d1)
        k = stop
