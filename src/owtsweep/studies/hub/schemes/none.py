"""NONE: no estimator. Position and velocity are zero.

A baseline: where its error is less than that of every scheme, the motion is too small for these
sensors.
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


class ZeroEstimator:
    """An estimator that ignores all measurements and always answers zero."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Return zero position and velocity."""
        return Estimate(np.zeros(2), np.zeros(2))


class NoEstimator(ChainScheme):
    """The baseline NONE, which no key tunes."""

    name = "NONE"
    sections = ()

    def start(self, known: Known) -> ZeroEstimator:
        """Return a new estimator that runs step by step."""
        return ZeroEstimator()

    def make_chain(self, known: Known, steps: int) -> Chain:
        """Return the baseline as a `Chain` for the batch engine."""
        return fix_chain(known.sensors, Line(holds=False, moves=False))


SCHEME = NoEstimator()
