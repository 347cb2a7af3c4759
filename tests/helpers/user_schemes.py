"""Schemes as users write them, some of them broken; tests name them by `_target_`."""

import numpy as np

from owtsweep import Estimate
from owtsweep.schemes import hub


class HoldLastFix(hub.Scheme):
    """The README's example: report the last fix, at rest. Linear, so amplitudes are free."""

    linear = True

    def __init__(self, name: str = "hold") -> None:
        self.name = name

    def start(self, known):
        """A fresh estimator."""
        return HoldLastFixEstimator()


class HoldLastFixEstimator:
    """Keeps what it was last told."""

    def __init__(self) -> None:
        self.position = np.zeros(2)

    def update(self, specific_force, position=None):
        """Take a fix, if there is one."""
        if position is not None:
            self.position = np.array(position)
        return Estimate(self.position, np.zeros(2))


class Saturated(HoldLastFix):
    """Not linear: never says more than 10 cm."""

    linear = False

    def start(self, known):
        """A fresh estimator that clips."""

        class Clipped(HoldLastFixEstimator):
            def update(self, specific_force, position=None):
                estimate = super().update(specific_force, position)
                return estimate._replace(position=np.clip(estimate.position, -0.1, 0.1))

        return Clipped()


class Broken(HoldLastFix):
    """Fails in the way it is told."""

    def __init__(self, how: str) -> None:
        super().__init__(f"broken by {how}")
        self.how = how

    def start(self, known):
        """An estimator that fails after 2 s."""
        outer = self

        class Failing(HoldLastFixEstimator):
            steps = 0

            def update(self, specific_force, position=None):
                self.steps += 1
                estimate = super().update(specific_force, position)
                if self.steps < 200:
                    return estimate
                if outer.how == "raising":
                    raise RuntimeError("the\nestimator lost its mind")
                if outer.how == "not finite":
                    return estimate._replace(position=np.array([np.nan, 0.0]))
                return estimate._replace(velocity=np.zeros(3))

        return Failing()


class Told(HoldLastFix):
    """It must be told the motion, as SKF must."""

    knows_motion = True


class Kernelless(HoldLastFix):
    """It says that it runs as a chain, and has none."""

    batched = "chain"


class NoScheme:
    """Lacks the whole contract."""
