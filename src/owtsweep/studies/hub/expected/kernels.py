"""Compiled loops of the expected engine: making sinusoids, and squaring what is left of them."""

from __future__ import annotations

from owtsweep.compiled import njit


@njit
def make_waves(first, end, real, imaginary, turn_real, turn_imaginary, gain, phasor, keep, force,
               wave):  # fmt: skip
    """Fill rows first ... end - 1 of force (and wave, if kept): lanes [cosines | sines] or sines.

    `real`, `imaginary` hold the sinusoids at step `first` and are turned on; `gain` makes forces
    of them.
    """
    n = len(gain)
    for k in range(first, end):
        for i in range(n):
            c, s = real[i], imaginary[i]
            if phasor:
                force[k, i] = gain[i] * c
                force[k, n + i] = gain[i] * s
                if keep:
                    wave[k, i] = c
                    wave[k, n + i] = s
            else:
                force[k, i] = gain[i] * s
            real[i] = c * turn_real[i] - s * turn_imaginary[i]
            imaginary[i] = c * turn_imaginary[i] + s * turn_real[i]


@njit
def add_squares(k0, count, settled, cycle, position, velocity, wave, rate, phasor, truth, sums,
                ring):  # fmt: skip
    """Add squared errors to sums (2 parts of the record, 2 measures, n) and to the cycle's.

    `ring` (slots, 2, n) holds the sums of the newest cycles, cycle q in slot q % slots. With
    `truth` the wave is what the position should be, and its rate the velocity.
    """
    n = sums.shape[2]
    slots = ring.shape[0]
    for j in range(count):
        k = k0 + j
        part = 0 if k < settled else 1
        slot = (k // cycle) % slots
        if k % cycle == 0:
            for i in range(n):
                ring[slot, 0, i] = 0.0
                ring[slot, 1, i] = 0.0
        for i in range(n):
            p, v = position[j, i], velocity[j, i]
            if phasor:
                q, w = position[j, n + i], velocity[j, n + i]
                if truth:
                    c, s = wave[k, i], wave[k, n + i]
                    p -= c
                    q -= s
                    v += rate[i] * s
                    w -= rate[i] * c
                a, b = p * p + q * q, v * v + w * w
            else:
                a, b = p * p, v * v
            sums[part, 0, i] += a
            sums[part, 1, i] += b
            ring[slot, 0, i] += a
            ring[slot, 1, i] += b
