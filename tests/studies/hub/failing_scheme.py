"""A user's scheme that fails in the middle of a record."""

import numpy as np

from owtsweep.evaluation.estimate import Estimate
from owtsweep.schemes import hub


class Failing(hub.Scheme):
    name = "Failing"
    linear = True

    def __init__(self, fault):
        self.fault = fault

    def start(self, known):
        return FailingEstimator(self.fault)


class FailingEstimator:
    def __init__(self, fault):
        self.fault = fault
        self.step = -1

    def update(self, specific_force, position=None):
        self.step += 1
        if self.step < 30:
            return Estimate(np.zeros(2), np.zeros(2))
        if self.fault == "raise":
            raise RuntimeError("no\nmore")
        size = 3 if self.fault == "shape" else 2
        return Estimate(np.full(size, np.nan), np.zeros(2))
