"""An estimator of one's own, for my_estimator.py: it corrects by fixed shares of the difference."""

import numpy as np

from owtsweep import Estimate
from owtsweep.schemes import hub


class AlphaBeta(hub.Scheme):
    """Position and velocity, integrated from the IMU, moved towards each fix."""

    name = "ALPHA_BETA"
    linear = True

    def __init__(self, alpha=0.5, beta=0.2):
        self.alpha, self.beta = alpha, beta

    def start(self, known):
        """Return a new estimator."""
        return Filter(known.sensors, self.alpha, self.beta)


class Filter:
    """The running estimator."""

    def __init__(self, sensors, alpha, beta):
        self.sensors, self.alpha, self.beta = sensors, alpha, beta
        self.position, self.velocity = np.zeros(2), np.zeros(2)

    def update(self, specific_force, position=None):
        """Take an IMU sample, and perhaps a fix."""
        self.position = self.position + self.sensors.step * self.velocity
        force = self.sensors.rotation @ specific_force
        self.velocity = self.velocity + self.sensors.step * force
        if position is not None:
            missing = position - self.position
            self.position = self.position + self.alpha * missing
            self.velocity = self.velocity + self.beta / self.sensors.fix_step * missing
        return Estimate(self.position, self.velocity)
