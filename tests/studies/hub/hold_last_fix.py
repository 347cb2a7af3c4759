"""The example of docs/own_scheme.md: hold the last fix."""

import numpy as np

from owtsweep import Estimate
from owtsweep.schemes import hub


class HoldLastFix(hub.Scheme):
    """Position: the last fix. Velocity: the change from the fix before, over the time between."""

    name = "HoldLastFix"
    linear = True

    def start(self, known):
        return HoldLastFixEstimator(known.sensors.fix_step)


class HoldLastFixEstimator:
    def __init__(self, fix_step):
        self.fix_step = fix_step
        self.last = None
        self.velocity = np.zeros(2)

    def update(self, specific_force, position=None):
        if position is not None:
            if self.last is not None:
                self.velocity = (position - self.last) / self.fix_step
            self.last = position.copy()
        return Estimate(np.zeros(2) if self.last is None else self.last, self.velocity)
