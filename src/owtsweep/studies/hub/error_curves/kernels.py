"""The compiled loops of the expected engine: sinusoids, a scheme's estimates, squared errors.

One call runs two groups of eight lanes (a cosine or a sine in each lane) through a long part of the
record. Sinusoids are made just before they are needed, in buffers that stay in the processor's
cache, and errors are squared as soon as they are computed. The structures are those of
`error_curves.layout` and `kernels.layout`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.layout import Fed
from owtsweep.studies.hub.kernels.runs import estimates
from owtsweep.vectors import WIDTH
from owtsweep.vectors.lanes import borrowed, groups, load, store


@njit
def advance(k0, stop, judged, course, waves, buffers, chain, memory):
    """Run two groups of eight lanes from step k0 until their response repeats, or to step `stop`.

    A lane is one sinusoidal test input. Whether the response repeats is first tested after the
    chunk (steps that are computed together) that reaches the step `judged`, and then every
    `course.every` steps. The other arguments are structures of `error_curves.layout` and
    `kernels.layout`.

    Returns
    -------
    int, bool
        The step that was reached, and whether the response repeats there.
    """
    lead, filled, force = course.lead, buffers.filled, buffers.force
    while k0 < stop:
        count = min(course.chunk, stop - k0)
        if waves.moving:
            if k0 + count - filled[0] > force[0].shape[0]:
                _move(force, k0 - lead - filled[0], filled[1] - filled[0])
                if waves.truth:
                    _move(buffers.wave, k0 - lead - filled[0], filled[1] - filled[0])
                filled[0] = k0 - lead
            make_waves(k0 + count, waves, buffers)
            filled[1] = k0 + count
        else:
            filled[0] = k0 - lead  # the buffer holds only zeros, which fit any step
        estimates(k0, count, Fed(force, filled[0], buffers.fixes), chain, memory)
        add_squares(k0, count, course, waves, buffers, memory.output)
        k0 += count
        if k0 >= judged:
            if repeats(k0 // course.cycle, course.lanes, course.tolerance, buffers.ring):
                return k0, True
            judged = k0 + course.every
    return k0, False


@njit
def repeats(newest, lanes, tolerance, ring):
    """Return whether, in each of the first `lanes` lanes, all complete cycles have equal sums.

    Lanes are counted through both groups of eight. `ring`, arranged as in `Buffers`, holds the sums
    of squared errors of the newest cycles (stretches of equal length). Sums are equal if they agree
    to the relative tolerance; NaN equals nothing. `newest` is the number of the last cycle, which
    is not complete and does not count.
    """
    slots = ring.shape[0] // 4
    for row in range(4):
        for lane in range(max(min(lanes - WIDTH * (row % 2), WIDTH), 0)):
            least, most = np.inf, -np.inf
            for slot in range(slots):
                if slot != newest % slots:
                    value = ring[4 * slot + row, lane]
                    # NaN never repeats
                    if not value >= 0.0:
                        return False
                    least, most = min(least, value), max(most, value)
            if not most - least <= tolerance * most:
                return False
    return True


@njit
def _move(buffers, first, stop):
    """Copy the rows first ... stop - 1 of each buffer (rows, 8) to the buffer's beginning."""
    rows = borrowed(buffers)
    for i in range(first, stop):
        store(rows, i - first, load(rows, i))


@njit
def make_waves(stop, waves, buffers):
    """Fill `buffers.force` with specific forces, scaled sinusoids, up to the step stop - 1.

    If the estimates should follow the sinusoids (waves.truth), `buffers.wave` is filled with the
    sinusoids. From step to step, a sinusoid is rotated by its angle. After every `waves.block`
    steps the sinusoids start anew from `waves.starts`, so that rounding errors do not accumulate.
    Between calls `waves.now` holds the sinusoids of the next step. `waves` and `buffers` are
    `Waves` and `Buffers`.
    """
    base, k = buffers.filled[0], buffers.filled[1]
    phasor, keep = waves.phasor, waves.truth
    u0, u1 = groups(borrowed(buffers.force))
    w0, w1 = groups(borrowed(buffers.wave))
    starts, now = borrowed((waves.starts,)), borrowed((waves.now,))
    fixed = borrowed((waves.turn_gain,))
    turn0, turn1 = load(fixed, 0), load(fixed, 1)  # cosine and sine of group 0's angle
    turn2, turn3 = load(fixed, 2), load(fixed, 3)  # of group 1's
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
def add_squares(k0, count, course, waves, buffers, output):
    """Add the squared errors of `count` steps, from step k0 on, to the sums in `buffers`.

    `buffers.sums` holds the sums of the record, `buffers.ring` the sums of each of the newest
    cycles. If waves.truth is set, the wave is the true position and the wave's time derivative is
    the true velocity; otherwise true position and velocity are zero. For phasors (a cosine and a
    sine of one frequency), the squares of cosine and sine are added together in group 0. `course`,
    `waves` and `buffers` are `Course`, `Waves` and `Buffers`; `output` holds the estimates
    (`Output`).
    """
    settled, cycle, base, ring = course.settled, course.cycle, buffers.filled[0], buffers.ring
    phasor, truth = waves.phasor, waves.truth
    p0, p1 = groups(borrowed(output.position))
    v0, v1 = groups(borrowed(output.velocity))
    w0, w1 = groups(borrowed(buffers.wave))
    omega = load(borrowed((waves.rate,)), 0)
    total, newest = borrowed((buffers.sums,)), borrowed((ring,))
    slots = ring.shape[0] // 4
    k, end = k0, k0 + count
    while k < end:
        stop = min((k // cycle + 1) * cycle, end)
        if k < settled:
            stop = min(stop, settled)
        part = 0 if k < settled else 4
        slot = 4 * ((k // cycle) % slots)
        if k % cycle == 0:
            for i in range(slot, slot + 4):
                store(newest, i, 0.0 * omega)
        a0, a1 = load(total, part), load(total, part + 1)
        b0, b1 = load(total, part + 2), load(total, part + 3)
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
        store(total, part, a0)
        store(total, part + 1, a1)
        store(total, part + 2, b0)
        store(total, part + 3, b1)
        store(newest, slot, c0)
        store(newest, slot + 1, c1)
        store(newest, slot + 2, d0)
        store(newest, slot + 3, d1)
        k = stop
