"""The motion of a moored buoy that is pulled out and released in still water (section 3.2)."""

from __future__ import annotations

import numpy as np

from owtsweep.motion.lines import Series
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.sections import Motion as MotionSection


def decay(
    motion: MotionSection, *, steps: int, step: float, lead: int, roll: float | None = None
) -> Series:
    """Return a free decay from the deflections `resonance.sigma`, at rest before time 0.

    Parameters
    ----------
    motion
        The section `motion`.
    steps, step
        Number of samples and sampling interval (s).
    lead
        Number of samples before the release.
    roll
        Deflection of roll in degrees, in place of the section's; None: that.
    """
    time = step * (np.arange(lead + steps) - lead)
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
