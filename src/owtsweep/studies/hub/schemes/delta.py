"""DELTA: the last position fix, moved on to the present with the velocity of the last two fixes.

A baseline: where its error is less than that of every scheme, the IMU is of no use.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.fix_chain import fix_chain
from owtsweep.studies.hub.fix_lines import Line
from owtsweep.studies.hub.known import Known, Sensors
from owtsweep.studies.hub.schemes.chained import ChainScheme


class ExtrapolatingEstimator:
    """An estimator that extrapolates the last two position fixes by a straight line.

    A fix is the position of some time ago, its delay; so the line is extended by the delay and the
    time since the fix arrived. The velocity is zero before the second fix, and the position is zero
    before the first one.
    """

    def __init__(self, sensors: Sensors) -> None:
        self.step, self.delay = sensors.step, sensors.delay
        self.fix: Array | None = None
        self.velocity: Array = np.zeros(2)
        self.age = 0  # number of steps since the last fix arrived

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take a position fix or None; return the extrapolated position, and the velocity."""
        self.age += 1
        if position is not None:
            if self.fix is not None:
                self.velocity = (position - self.fix) / (self.age * self.step)
            self.fix = np.array(position, dtype=float)
            self.age = 0
        if self.fix is None:
            return Estimate(np.zeros(2), np.zeros(2))
        ahead = (self.delay + self.age) * self.step
        return Estimate(self.fix + ahead * self.velocity, self.velocity)


class Delta(ChainScheme):
    """The baseline DELTA, which no key tunes."""

    name = "DELTA"
    sections = ()

    def start(self, known: Known) -> ExtrapolatingEstimator:
        """Return a new estimator that runs step by step."""
        return ExtrapolatingEstimator(known.sensors)

    def make_chain(self, known: Known, steps: int) -> Chain:
        """Return the baseline as a `Chain` for the batch engine."""
        return fix_chain(known.sensors, Line(holds=True, moves=True))


SCHEME = Delta()
