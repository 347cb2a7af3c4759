"""HOLD: the last position fix is held until the next one. The velocity is zero.

A baseline: where its error is less than that of every scheme, the IMU is of no use.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.fix_chain import fix_chain
from owtsweep.studies.hub.fix_lines import Line
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.schemes.chained import ChainScheme


class HoldingEstimator:
    """An estimator that answers with the last position fix; with zero before the first one."""

    def __init__(self) -> None:
        self.fix: Array = np.zeros(2)

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take a position fix or None; return the last fix, and zero velocity."""
        if position is not None:
            self.fix = np.array(position, dtype=float)
        return Estimate(self.fix, np.zeros(2))


class HoldTheFix(ChainScheme):
    """The baseline HOLD, which no key tunes."""

    name = "HOLD"
    sections = ()

    def start(self, known: Known) -> HoldingEstimator:
        """Return a new estimator that runs step by step."""
        return HoldingEstimator()

    def make_chain(self, known: Known, steps: int) -> Chain:
        """Return the baseline as a `Chain` for the batch engine."""
        return fix_chain(known.sensors, Line(holds=True, moves=False))


SCHEME = HoldTheFix()
