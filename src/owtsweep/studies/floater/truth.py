"""The truth of a record: how the floating structure moves, and what ideal sensors would feel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.studies.floater.attitude import find_body_rates, find_specific_force
from owtsweep.studies.floater.contract import Truth
from owtsweep.studies.floater.motion_decay import decay
from owtsweep.studies.floater.motion_recorded import read_motion
from owtsweep.studies.floater.motion_synthetic import Series, draw_motion

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig

#: Samples that are known before the oldest report, for irregular reports.
MARGIN = 20


@dataclass(frozen=True)
class Motion:
    """The motion of a record, and what came before it.

    Attributes
    ----------
    truth
        The record.
    series
        Position and its derivatives with a lead before the record.
    lead
        Number of samples of the lead.
    """

    truth: Truth
    series: Series
    lead: int

    def at(self, times: Array) -> Array:
        """Return positions at times in s, shape (n, 6).

        Between samples a polynomial of degree 5 has position, velocity and acceleration of both
        neighbours: the error is of the order of the sixth power of the step. Times before the lead
        get its first position.
        """
        step, (x, v, a) = self.truth.step, self.series
        place = np.clip(np.asarray(times) / step + self.lead, 0.0, len(x) - 1.0)
        left = np.minimum(place.astype(int), len(x) - 2)
        s = (place - left)[:, None]
        right = left + 1
        gap, mean = x[right] - x[left], step * v[left]
        c2 = 0.5 * step**2 * a[left]
        rest = gap - mean - c2
        slope = step * v[right] - mean - 2.0 * c2
        bend = step**2 * a[right] - 2.0 * c2
        c3 = 10.0 * rest - 4.0 * slope + 0.5 * bend
        c4 = -15.0 * rest + 7.0 * slope - bend
        c5 = 6.0 * rest - 3.0 * slope + 0.5 * bend
        return np.asarray(x[left] + s * (mean + s * (c2 + s * (c3 + s * (c4 + s * c5)))))


def make_truth(config: FloaterConfig, replicate: int, roll: float | None = None) -> Motion:
    """Make the motion of a record.

    Parameters
    ----------
    config
        The configuration.
    replicate
        Number of the record: which random numbers. A decay and a recorded motion have none.
    roll
        Standard deviation of the roll angle in degrees; None: that of the section `motion`.

    Raises
    ------
    InputError
        If a recorded motion cannot be used.
    """
    record, motion = config.record, config.motion
    step, steps = 1.0 / record.rate, record.steps
    lead = min(int(np.ceil(max(config.grid.delay))) + MARGIN, steps)
    if motion.kind == "recorded":
        series = read_motion(motion, steps=steps, step=step, lead=lead)
    elif motion.kind == "decay":
        series = decay(motion, steps=steps, step=step, lead=lead, roll=roll)
    else:
        draws = partial(stream, config.seed, config.study, (), replicate)
        series = draw_motion(motion, draws, steps=steps, step=step, lead=lead, roll=roll)
    position, velocity, acceleration = (part[lead:] for part in series)
    angles = position[:, 3:]
    truth = Truth(
        step=step,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        rate=find_body_rates(angles, velocity[:, 3:], motion.attitude),
        specific_force=find_specific_force(angles, acceleration[:, :3], motion.attitude),
    )
    return Motion(truth, series, lead)
