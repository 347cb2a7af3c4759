"""From Euler angles to what sensors fixed to the body feel.

Angles are roll, pitch, yaw, turned in the order yaw, pitch, roll (Mehammer et al. 2018, section
2.2). The frame is NED: its third axis points down, so a body at rest feels (0, 0, -g).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY

#: Angles to first order, or the full equations.
Kinematics = Literal["small", "exact"]
#: Pitch in rad beyond which rates of Euler angles lose their meaning (89 degrees).
STEEPEST = np.deg2rad(89.0)


def find_body_rates(angles: Array, rates: Array, kinematics: Kinematics) -> Array:
    """Return angular velocities in the body's frame, rad/s, shape (steps, 3).

    This is Eq. (2) the other way round.

    Parameters
    ----------
    angles, rates
        Euler angles in rad and their derivatives in rad/s, shape (steps, 3).
    kinematics
        With "small", both rates are the same.
    """
    if kinematics == "small":
        return rates.copy()
    phi, theta, _ = angles.T
    roll, pitch, yaw = rates.T
    return np.column_stack(
        [
            roll - np.sin(theta) * yaw,
            np.cos(phi) * pitch + np.sin(phi) * np.cos(theta) * yaw,
            -np.sin(phi) * pitch + np.cos(phi) * np.cos(theta) * yaw,
        ]
    )


def find_specific_force(angles: Array, acceleration: Array, kinematics: Kinematics) -> Array:
    """Return what ideal accelerometers fixed to the body read, m/s^2, shape (steps, 3).

    Parameters
    ----------
    angles
        Euler angles in rad, shape (steps, 3).
    acceleration
        Acceleration of the body's origin in the basin's frame, m/s^2, shape (steps, 3).
    kinematics
        With "small", only gravity is turned, by angles to first order.
    """
    felt = acceleration.copy()
    felt[:, 2] -= GRAVITY
    if kinematics == "small":
        felt[:, 0] += GRAVITY * angles[:, 1]
        felt[:, 1] -= GRAVITY * angles[:, 0]
        return felt
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_euler("ZYX", angles[:, ::-1]).inv().apply(felt)
    return np.asarray(turned)
