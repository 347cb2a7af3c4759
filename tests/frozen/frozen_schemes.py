"""Users' schemes of the frozen runs: one that works, one that is not linear, one that fails."""

import numpy as np

from owtsweep import Estimate
from owtsweep.schemes import hub


class HoldLastFix(hub.Scheme):
    """Says that the hub rests at the last fix."""

    linear = True

    def __init__(self, name="HoldLastFix"):
        self.name = name

    def start(self, known):
        return _Holding()


class _Holding:
    def __init__(self):
        self.position = np.zeros(2)

    def update(self, specific_force, position=None):
        if position is not None:
            self.position = np.array(position)
        return Estimate(self.position, np.zeros(2))


class Saturated(HoldLastFix):
    """Never says more than 10 cm."""

    linear = False

    def __init__(self):
        super().__init__("Saturated")

    def start(self, known):
        return _Clipping()


class _Clipping(_Holding):
    def update(self, specific_force, position=None):
        estimate = super().update(specific_force, position)
        return estimate._replace(position=np.clip(estimate.position, -0.1, 0.1))


class Failing(HoldLastFix):
    """Raises an exception at step 30."""

    def __init__(self):
        super().__init__("Failing")

    def start(self, known):
        return _Raising()


class _Raising(_Holding):
    step = -1

    def update(self, specific_force, position=None):
        self.step += 1
        if self.step == 30:
            raise RuntimeError("no more")
        return super().update(specific_force, position)
