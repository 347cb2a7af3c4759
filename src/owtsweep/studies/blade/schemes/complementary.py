"""COMPLEMENTARY: fixed gains: gyroscopes and gravity for the attitude, fixes for the position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.estimation.complementary import blend_fixes, place_poles
from owtsweep.gravity import GRAVITY
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import begin


@dataclass(frozen=True)
class Complementary:
    """The filter, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        setting = self.setting
        s, _ = begin(setting)
        interval = measured.step * float(np.diff(np.flatnonzero(measured.due)).max(initial=1))
        alpha, beta = place_poles(find_crossover(setting, interval), interval)
        states = np.empty((len(measured.rate), len(s)))
        gains = (float(alpha), float(beta), 1.0 / setting.tuning.levelling)
        blend_fixes(
            measured.fixes[:, 0].copy(), setting.geometry.levers[0], measured.due,
            measured.specific_force, measured.rate, measured.step, gains, s, states,
        )  # fmt: skip
        rotation = Rotation.from_quat(states[:, 6:10], scalar_first=True).as_matrix()
        to_root = setting.geometry.to_root
        whirl = np.cross(measured.rate, to_root)
        return Estimates(
            root=states[:, :3] + rotation @ to_root,
            root_velocity=states[:, 3:6] + np.einsum("nij,nj->ni", rotation, whirl),
            rotation=rotation,
        )


def find_crossover(setting: Setting, interval: float) -> float:
    """Return the crossover in rad/s: (q / r)^(1/4) of white noise, as a Kalman filter has it.

    `interval` is the time between two fixes in s. q and r are the intensities of the noise of
    accelerations and of fixes. A levelled acceleration is wrong by the bias and by gravity on the
    tilt, so noise of the size of both counts as lasting as long as the levelling.
    """
    slow = setting.force_bias**2 + (GRAVITY * setting.start_sigma[2]) ** 2
    q = setting.force_sigma**2 * setting.step + 2.0 * slow * setting.tuning.levelling
    r = float(np.mean(setting.fix_sigma**2)) * interval
    return float(setting.tuning.crossover * (q / r) ** 0.25)


SCHEME = Direct("COMPLEMENTARY", Complementary)
