"""The truth of a record: how the floating structure moves, and what ideal sensors would feel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.angles import find_body_rates, make_rotation
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Series, Span, interpolate
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contract import Truth
from owtsweep.studies.floater.motion_recorded import read_motion
from owtsweep.studies.floater.motion_synthetic import decay, draw_motion

#: Kind of motion -> what makes it, of the section `motion`, streams, samples and roll.
DRAW = {"synthetic": draw_motion, "decay": decay, "recorded": read_motion}
#: Samples that are known before the oldest report, for irregular reports.
MARGIN = 20


@dataclass(frozen=True)
class Motion:
    """The motion of the record with a number, `replicate`.

    series: Position and its derivatives, with `lead` samples before the record.
    """

    truth: Truth
    series: Series
    lead: int
    replicate: int

    def at(self, times: Array) -> Array:
        """Return positions at times in s, shape (n, 6)."""
        return interpolate(self.series, self.truth.step, self.lead, times)


def make_truth(config: FloaterConfig, replicate: int, roll: float | None = None) -> Motion:
    """Make the motion of a record.

    A decay and a recorded motion have no random numbers. `roll` is the standard deviation of the
    roll angle in degrees; None: that of the section `motion`. Raise `InputError` if a recorded
    motion cannot be used.
    """
    record, motion = config.record, config.motion
    step, steps = 1.0 / record.rate, record.steps
    lead = min(int(np.ceil(max(config.grid.delay))) + MARGIN, steps)
    span = Span(steps, step, lead)
    series = DRAW[motion.kind](motion, config.draws(replicate), span, roll)
    position, velocity, acceleration = (part[lead:] for part in series)
    angles, rates = position[:, 3:], velocity[:, 3:]
    small = motion.attitude == "small"
    truth = Truth(
        step=step,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        rate=rates.copy() if small else find_body_rates(angles, rates),
        specific_force=find_specific_force(angles, acceleration[:, :3], small=small),
    )
    return Motion(truth, series, lead, replicate)


def find_specific_force(angles: Array, acceleration: Array, *, small: bool) -> Array:
    """Return what ideal accelerometers fixed to the body read, m/s^2, shape (steps, 3).

    The third axis points down, so a body at rest feels (0, 0, -g). Euler angles are in rad, the
    acceleration of the body's origin in the basin's frame in m/s^2, shape (steps, 3) each. If
    `small`, only gravity is turned, by angles to first order.
    """
    felt = acceleration.copy()
    felt[:, 2] -= GRAVITY
    if small:
        felt[:, 0] += GRAVITY * angles[:, 1]
        felt[:, 1] -= GRAVITY * angles[:, 0]
        return felt
    return np.asarray(np.einsum("nji,nj->ni", make_rotation(angles), felt))
