"""The compiled loops of the expected engine: sinusoids, a scheme's estimates, squared errors.

One call runs sixteen lanes (a cosine or a sine in each) through a long part of the record.
Sinusoids are made just before they are needed, in buffers that stay in the processor's cache, and
errors are squared as soon as they are computed. The arguments are structures of
`error_curves.layout` and `kernels.layout`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit, part
from owtsweep.studies.hub.kernels.chain import estimate, leave
from owtsweep.studies.hub.kernels.feeding import keep_rows
from owtsweep.studies.hub.kernels.layout import WIDTH, Fed


@njit
def advance(k0, stop, judged, course, waves, buffers, chain, memory):
    """Run all lanes from step k0 until their response repeats, or to step `stop`.

    Repetition is first tested after the chunk that reaches the step `judged`, and then every
    `course.every` steps. Return the step that was reached, and whether the response repeats there.
    """
    lead, filled, force = course.lead, buffers.filled, buffers.force
    while k0 < stop:
        count = min(course.chunk, stop - k0)
        if waves.moving:
            if k0 + count - filled[0] > len(force):
                keep_rows(k0 - lead - filled[0], filled[1] - filled[0], force)
                keep_rows(k0 - lead - filled[0], filled[1] - filled[0], buffers.wave)
                filled[0] = k0 - lead
            make_waves(k0 + count, waves, buffers)
            filled[1] = k0 + count
        else:
            filled[0] = k0 - lead  # the buffer holds only zeros, which fit any step
        estimate(k0, count, Fed(force, filled[0], buffers.fixes), chain, memory, False)
        add_squares(k0, count, course, waves, buffers, memory.steps)
        leave(count, chain.filter.window, memory.steps)
        k0 += count
        if k0 >= judged:
            if repeats(k0 // course.cycle, course.lanes, course.tolerance, buffers.ring):
                return k0, True
            judged = k0 + course.every
    return k0, False


@njit
def repeats(newest, lanes, tolerance, ring):
    """Return whether, in each of the first `lanes` lanes, all complete cycles have equal sums.

    `ring` is that of `Buffers`. Sums are equal if they agree to the relative tolerance; NaN equals
    nothing. `newest` is the number of the last cycle, which is not complete and does not count.
    """
    slots = len(ring)
    for measure in range(2):
        for lane in range(lanes):
            least, most = np.inf, -np.inf
            for slot in range(slots):
                if slot != newest % slots:
                    value = ring[slot, measure, lane]
                    # NaN never repeats
                    if not value >= 0.0:
                        return False
                    least, most = min(least, value), max(most, value)
            if not most - least <= tolerance * most:
                return False
    return True


@part
def turn(now):
    """Take the sinusoids one step further: (c, s) is turned by the angle per step."""
    for i in range(len(now.c)):
        c, s = now.c[i], now.s[i]
        now.c[i] = c * now.turn_c[i] - s * now.turn_s[i]
        now.s[i] = c * now.turn_s[i] + s * now.turn_c[i]


@njit
def make_waves(stop, waves, buffers):
    """Fill `buffers.force` with specific forces, scaled sinusoids, up to the step stop - 1.

    If the estimates should follow the sinusoids (waves.truth), `buffers.wave` is filled with them
    and their rates. After every `waves.block` steps the sinusoids start again from `waves.starts`,
    so that rounding errors do not accumulate.
    """
    base, now, starts = buffers.filled[0], waves.now[0], waves.starts
    force, wave, truth = buffers.force, buffers.wave, waves.truth
    for k in range(buffers.filled[1], stop):
        if k % waves.block == 0:
            block = k // waves.block
            for i in range(len(now.c)):
                now.c[i], now.s[i] = starts[2 * block, i], starts[2 * block + 1, i]
        for i in range(len(now.c)):
            force[k - base, i] = now.force[i] * now.s[i]
        if truth:
            for i in range(len(now.c)):
                wave[k - base, i] = now.s[i]
                wave[k - base, 2 * WIDTH + i] = now.rate[i] * now.c[i]
        turn(now)


@part
def square(t, x, wave, at):
    """Add the squared errors of the estimates in the row x; row `at` of `wave` is the truth."""
    for i in range(len(t.p)):
        t.p[i], t.v[i] = x.p[i], x.v[i]
    for i in range(len(t.wave)):
        t.wave[i] = wave[at, i]
    for i in range(len(t.p)):
        p, v = t.p[i] - t.wave[i], t.v[i] - t.wave[2 * WIDTH + i]
        t.pp[i] += p * p
        t.vv[i] += v * v


@njit
def add_squares(k0, count, course, waves, buffers, steps):
    """Add the squared errors of `count` steps, from step k0 on, to the sums in `buffers`.

    If waves.truth is set, the wave is the true position and its rate the true velocity; otherwise
    both are zero. For phasors, the squares of cosine and sine are added together. `steps` are
    `Memory.steps`.
    """
    cycle, ring, sums, t = course.cycle, buffers.ring, buffers.sums, buffers.errors[0]
    k, end = k0, k0 + count
    while k < end:
        stop = min((k // cycle + 1) * cycle, end)
        if k < course.settled:
            stop = min(stop, course.settled)
        total, newest = sums[0 if k < course.settled else 1], ring[(k // cycle) % len(ring)]
        if k % cycle == 0:
            for i in range(len(t.p)):
                newest[0, i] = newest[1, i] = 0.0
        for i in range(len(t.p)):
            t.pp[i] = t.vv[i] = 0.0
        for now in range(k, stop):
            at = now - buffers.filled[0] if waves.truth else 0  # without a truth, row 0 is zero
            square(t, steps[1 + now - k0], buffers.wave, at)
        if waves.phasor:
            for i in range(WIDTH):
                t.pp[i] += t.pp[WIDTH + i]
                t.vv[i] += t.vv[WIDTH + i]
        for i in range(len(t.p)):
            total[0, i] += t.pp[i]
            total[1, i] += t.vv[i]
            newest[0, i] += t.pp[i]
            newest[1, i] += t.vv[i]
        k = stop
