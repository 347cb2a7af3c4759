"""Simulates a floating structure in six degrees of freedom: in waves, or released in still water.

In waves each degree of freedom is a sum of lines with random phases that repeats after twice the
record, so nothing repeats inside one, and the motion before it is known. Position, velocity and
acceleration are exact derivatives of each other. A resonance is white noise through an oscillator,
up to `HIGHEST` times its natural frequency; waves have a JONSWAP spectrum up to the same multiple
of its peak. Above that there is no motion: an accelerometer would see what a basin calls noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.motion.lines import (
    HIGHEST,
    Series,
    Span,
    find_frequencies,
    respond,
    sample,
    scale_to_one,
)
from owtsweep.streams import Streams
from owtsweep.studies.floater.config import Motion as MotionSection
from owtsweep.studies.floater.contract import DOF
from owtsweep.waves import Sea

#: Coupled degrees of freedom: the second follows the first, with a sign.
COUPLED = {"theta": ("x", 1.0), "phi": ("y", -1.0)}


def draw_motion(
    motion: MotionSection, draws: Streams, span: Span, roll: float | None = None
) -> Series:
    """Draw a motion of lead + steps samples; the lead is at most as long as the record.

    `roll` is the standard deviation of the roll angle in degrees; None: that of the section.
    """
    frequency = find_frequencies(span.steps, span.step)
    freedoms, coupling = [motion.freedoms[name] for name in DOF], motion.surge_pitch
    resonances = [each.resonance for each in freedoms]
    answer = [respond(frequency, each.period, each.damping) for each in resonances]
    slow = _draw_lines(np.column_stack(answer), coupling, draws, "resonance")
    fast = _draw_lines(_describe_waves(motion, frequency), coupling, draws, "waves")
    lines = slow * [each.sigma for each in resonances]
    lines += fast * [each.waves for each in freedoms]
    lines[:, 3:] *= np.pi / 180.0
    mean = np.array([each.mean for each in freedoms])
    mean[3:] = np.deg2rad(mean[3:])
    if roll is not None:
        column = DOF.index("phi")
        own = np.sqrt(0.5 * np.sum(np.abs(lines[:, column]) ** 2))
        lines[:, column] *= np.deg2rad(roll) / own
    series = sample(lines, *span)
    return series._replace(position=mean + series.position)


def _describe_waves(motion: MotionSection, frequency: Array) -> Array:
    """Return the spectral density of the waves' part, up to a factor, shape (lines, 6)."""
    inside = (frequency > 0.0) & (frequency * motion.wave_period <= HIGHEST)
    density = np.zeros(len(frequency))
    # The spectrum's shape alone counts; scaled to a period of 10 s it is inside `Sea`'s band.
    scaled = frequency[inside] * motion.wave_period / 10.0
    density[inside] = Sea(1.0, 10.0, motion.wave_gamma).density(scaled)
    return np.repeat(density[:, None], 6, axis=1)


def _draw_lines(
    density: Array, coupling: float, draws: Streams, words: str
) -> NDArray[np.complex128]:
    """Draw complex amplitudes with a variance of 1 per column, shape (lines, 6).

    Lines of a coupled degree of freedom have the correlation `coupling` with those that it follows.
    """
    units = {}
    for name in DOF:
        draw = draws(f"{words}_{name}").standard_normal((2, len(density)))
        units[name] = (draw[0] + 1j * draw[1]) / np.sqrt(2.0)
    for name, (leader, sign) in COUPLED.items():
        own = np.sqrt(1.0 - coupling**2)
        units[name] = sign * coupling * units[leader] + own * units[name]
    drawn = scale_to_one(np.sqrt(density) * np.column_stack([units[name] for name in DOF]))
    return np.asarray(drawn, dtype=np.complex128)


def decay(motion: MotionSection, draws: object, span: Span, roll: float | None = None) -> Series:
    """Return a free decay from the deflections `resonance.sigma`, at rest before time 0.

    That is a moored buoy, pulled out and released in still water (section 3.2), after the lead.
    Nothing is random. `roll` is the deflection of roll in degrees; None: that of the section.
    """
    time = span.step * (np.arange(span.lead + span.steps) - span.lead)
    moving = time >= 0.0
    later = np.where(moving, time, 0.0)
    columns = []
    for name in DOF:
        freedom = motion.freedoms[name]
        unit = 1.0 if name in "xyz" else np.pi / 180.0
        size = freedom.resonance.sigma if roll is None or name != "phi" else roll
        zeta, natural = freedom.resonance.damping, 2.0 * np.pi / freedom.resonance.period
        damped = natural * np.sqrt(1.0 - zeta**2)
        faded = size * np.exp(-zeta * natural * later)
        cosine, sine = np.cos(damped * later), np.sin(damped * later)
        position = faded * (cosine + zeta * natural / damped * sine)
        velocity = -faded * natural**2 / damped * sine
        acceleration = -(natural**2) * position - 2.0 * zeta * natural * velocity
        columns.append(unit * np.stack([freedom.mean + position, velocity, acceleration * moving]))
    return Series(*np.stack(columns, axis=-1))
