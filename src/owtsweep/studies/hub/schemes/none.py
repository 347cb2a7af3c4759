"""NONE: no estimator. Position and velocity are zero.

A baseline: where its error is less than that of every scheme, the motion is too small for these
sensors.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate
from owtsweep.studies.hub.chain import LONGEST_TRANSIENT, Chain, shared
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.fix_chain import fix_chain
from owtsweep.studies.hub.fix_lines import Line


class ZeroEstimator:
    """An estimator that ignores all measurements and always answers zero."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Return zero position and velocity."""
        return Estimate(np.zeros(2), np.zeros(2))


class NoEstimator:
    """The baseline NONE, which no key tunes."""

    name = "NONE"
    linear = True
    sections = ()

    def start(self, sensors: Sensors, tuning: Any) -> ZeroEstimator:
        """Return a new estimator that runs step by step."""
        return ZeroEstimator()

    @shared
    def kernel(self, sensors: Sensors, tuning: Any, steps: int = LONGEST_TRANSIENT) -> Chain:
        """Return the baseline as a `Chain` for the batch engine."""
        return fix_chain(sensors, Line(holds=False, moves=False))


SCHEME = NoEstimator()
