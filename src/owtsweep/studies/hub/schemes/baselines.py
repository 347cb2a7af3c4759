"""The baselines of the hub study, which use nothing but the position fixes.

NONE: position and velocity are zero. HOLD: the last fix is held until the next one; the velocity is
zero. DELTA: the last fix, moved on to the present with the velocity of the last two fixes.

Where NONE has less error than every scheme, the motion is too small for these sensors; where HOLD
or DELTA has, the IMU is of no use.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import Chain, Line
from owtsweep.studies.hub.contract import Estimator, Known
from owtsweep.studies.hub.lines import fix_chain
from owtsweep.studies.hub.schemes.chained import ChainScheme
from owtsweep.studies.hub.sensors import Sensors


class ZeroEstimator:
    """An estimator that ignores all measurements and always answers zero."""

    def __init__(self, sensors: Sensors) -> None:
        pass

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        return Estimate(np.zeros(2), np.zeros(2))


class HoldingEstimator:
    """An estimator that answers with the last position fix; with zero before the first one."""

    def __init__(self, sensors: Sensors) -> None:
        self.fix: Array = np.zeros(2)

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        if position is not None:
            self.fix = np.array(position, dtype=float)
        return Estimate(self.fix, np.zeros(2))


class ExtrapolatingEstimator:
    """An estimator that extrapolates the last two position fixes by a straight line.

    It is extended by the delay of a fix and the time since the fix arrived. The velocity is zero
    before the second fix, and the position is zero before the first one.
    """

    def __init__(self, sensors: Sensors) -> None:
        self.step, self.delay = sensors.step, sensors.delay
        self.fix: Array | None = None
        self.velocity: Array = np.zeros(2)
        self.age = 0  # number of steps since the last fix arrived

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
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


class Baseline(ChainScheme):
    """A baseline, which no key tunes: its line between two fixes, and the line step by step."""

    sections = ()

    def __init__(self, name: str, line: Line, estimator: Callable[[Sensors], Estimator]) -> None:
        self.name, self._line, self._estimator = name, line, estimator

    def start(self, known: Known) -> Estimator:
        return self._estimator(known.sensors)

    def make_chain(self, known: Known, steps: int) -> Chain:
        return fix_chain(known.sensors, self._line)


NONE = Baseline("NONE", Line(holds=False, moves=False), ZeroEstimator)
HOLD = Baseline("HOLD", Line(holds=True, moves=False), HoldingEstimator)
DELTA = Baseline("DELTA", Line(holds=True, moves=True), ExtrapolatingEstimator)
