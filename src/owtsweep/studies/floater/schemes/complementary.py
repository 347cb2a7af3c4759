"""COMPLEMENTARY: positions below a crossover frequency, accelerations above it.

Its crossover is `filters.crossover` times the one that is best for the noise and the bias that it
assumes. With body-fixed sensors the angles blend rates in place of accelerations, which are not
measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.inertial.complementary import blend_acceleration, blend_rate, place_poles
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.contract import DOF, Direct, Estimates, Measured, Setting
from owtsweep.studies.floater.schemes.linear import ANGLES, part_columns, read_inputs
from owtsweep.studies.floater.schemes.printed import find_start

#: The fastest crossover, as a part of the sampling frequency in rad/s: a filter that follows each
#: report by three quarters.
FASTEST = 0.15


@dataclass(frozen=True)
class Complementary:
    """The filter with its crossover of each degree of freedom in rad/s, shape (6,)."""

    setting: Setting
    crossover: Array

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        position, _, acceleration, rate, step = read_inputs(self.setting, measured)
        found = np.empty((*position.shape, 2))
        start = find_start(position)[:, 0]
        for i, w in enumerate(self.crossover):
            if self.setting.body and i in ANGLES:
                gain = 1.0 - np.exp(-w * step)
                blend_rate(position[i], rate[i], step, gain, start[i], found[i])
            else:
                gains = place_poles(w, step)
                blend_acceleration(position[i], acceleration[i], step, gains, start[i], found[i])
        return Estimates(*part_columns(found))


def find_crossover(setting: Setting, column: int) -> float:
    """Return the best crossover w of a degree of freedom for the position, rad/s.

    Noise of positions (R) and accelerations (Q) of steps h, and a bias b, move the position by

        1.5 / sqrt(2) R h w + 1 / sqrt(8) Q h / w^3 + b^2 / w^4

    in the mean square. Its minimum is a root of w^5 - w Q / R - 8 sqrt(2) / 3 b^2 / (R h); without
    a bias that is the crossover of the settled Kalman filter, the fourth root of Q / R.
    """
    R = setting.position_sigma[column] ** 2
    Q = setting.acceleration_sigma[column] ** 2
    pushed = 8.0 * np.sqrt(2.0) / 3.0 * setting.bias_sigma[column] ** 2 / (R * setting.step)
    roots = np.roots([1.0, 0.0, 0.0, 0.0, -Q / R, -pushed])
    return float(max(root.real for root in roots))


def prepare(setting: Setting) -> Complementary:
    """Choose the crossover for a setting.

    Raise `Unable` if accelerations are assumed to have no noise, so that positions never count.
    """
    best = np.array([find_crossover(setting, i) for i in range(len(DOF))])
    if setting.body:
        best[list(ANGLES)] = setting.rate_sigma / setting.position_sigma[list(ANGLES)]
    if not np.all(best > 0.0):
        raise Unable("COMPLEMENTARY has no crossover: it assumes that accelerations have no noise")
    fastest = FASTEST * 2.0 * np.pi / setting.step
    return Complementary(setting, np.minimum(setting.tuning.crossover * best, fastest))


SCHEME = Direct("COMPLEMENTARY", prepare)
