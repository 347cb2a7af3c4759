"""How far filters on reported positions alone should follow them: lag against noise."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.floater.contract import Setting


def balance_lag_and_noise(setting: Setting) -> Array:
    """Return the cut-off in rad/s that is best for the velocity, shape (6,).

    A Butterworth filter of order 2 with the cut-off w is late by sqrt(2) / w, which moves the
    velocity by sqrt(2) / w times the acceleration. White noise of the variance R in reports at
    intervals h gives its derivative the variance R h w^3 / sqrt(8). The sum is least at

        w^5 = 8 sqrt(2) / 3 x sigma_a^2 / (R h)

    with the standard deviation sigma_a of the motion's acceleration.
    """
    ratio = setting.motion_sigma[2] / setting.position_sigma
    return np.asarray((8.0 * np.sqrt(2.0) / 3.0 * ratio**2 / setting.step) ** 0.2)
