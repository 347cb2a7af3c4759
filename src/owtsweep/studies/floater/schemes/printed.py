"""What the two predictors of Mehammer et al. (2018) share: noise, start, measurements.

As printed and as the author's code has it, but for what cannot have been meant: process noise v_1
enters by the right G_d (Eq. 9 prints I), and the Riccati step is that of Eq. (14) (the code lacks
C P there). So both: noise of the size of accelerations drives positions as well as velocities, and
the estimate of a sample knows the reports before it.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.kinematic_predictor import make_noise
from owtsweep.studies.floater.contract import DOF, Setting
from owtsweep.studies.floater.schemes.linear import ANGLES


def process_noise(setting: Setting) -> Array:
    """Return Q of Eq. (10) for each degree of freedom, shape (6, 2, 2).

    The author's v_1 has the size of the accelerations' noise in all 12 elements. With body-fixed
    sensors, angular accelerations are no inputs but process noise, and nothing else moves the
    angles (section 2.2).
    """
    sigma = np.column_stack([setting.acceleration_sigma] * 2)
    if setting.body:
        sigma[ANGLES, 0] = 0.0
    return np.stack([make_noise(setting.step, both) for both in sigma])


def predict_ahead(setting: Setting, estimate: Array, acceleration: Array) -> None:
    """Predict estimates by the declared delay of the reports that they rest on (section 3.2).

    Parameters
    ----------
    setting
        With `filters.delay` "declared"; else nothing is done.
    estimate
        Positions and velocities, shape (6, steps, 2); overwritten.
    acceleration
        Shape (6, steps), held over the delay.
    """
    if setting.tuning.delay == "declared":
        ahead = setting.delay
        estimate[..., 0] += ahead * estimate[..., 1] + 0.5 * ahead**2 * acceleration
        estimate[..., 1] += ahead * acceleration


def output_noise(setting: Setting, column: int) -> Array:
    """Return the variances of the outputs of a degree of freedom: position, for angles the rate."""
    variances = [setting.position_sigma[column] ** 2]
    if column in ANGLES:
        variances.append(setting.rate_sigma[column - 3] ** 2)
    return np.array(variances)


def begin(setting: Setting, reported: Array) -> tuple[Array, Array]:
    """Return positions and velocities at sample 0, (6, 2), and their covariance, (6, 2, 2).

    That is the first report, at rest, or the truth, as in the paper's tests with virtual data.
    """
    if setting.start is not None:
        return np.ascontiguousarray(setting.start.T), np.zeros((len(DOF), 2, 2))
    sigmas = np.stack([setting.position_sigma, setting.motion_sigma[1]], axis=-1)
    return find_start(reported), sigmas[:, :, None] ** 2 * np.eye(2)


def find_start(reported: Array) -> Array:
    """Return positions and velocities at sample 0, shape (6, 2): the first report, at rest.

    `reported` has the shape (6, steps).
    """
    there = np.all(np.isfinite(reported), axis=0)
    start = np.zeros((len(DOF), 2))
    if there.any():
        start[:, 0] = reported[:, np.argmax(there)]
    return start
