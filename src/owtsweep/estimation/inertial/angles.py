"""Euler angles of a body's attitude, its rotation matrices and body rates, of whole records.

Angles are roll, pitch and yaw, and the matrix turns vectors of the body into the frame at rest:

    R = Rz(yaw) Ry(pitch) Rx(roll)

This is the order of Mehammer et al. (2018), section 2.2, where z points down, and of Maes et al.
(2018), Eqs. 2 and 3, where z points up and the heading psi is positive clockwise seen from above:
R = T_psi T_theta T_phi = Rz(-psi) Ry(theta) Rx(phi). In their Eq. 3 the printed T_phi has a 1 in
row 1, column 3. With it, T_phi is no rotation; it is 0 here.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array


def from_heading(angles: Array) -> Array:
    """Return roll, pitch and yaw of heading, pitch and roll, (samples, 3); also of derivatives."""
    return angles[:, ::-1] * [1.0, 1.0, -1.0]


def to_heading(angles: Array) -> Array:
    """Return heading, pitch and roll of roll, pitch and yaw, (samples, 3); also of derivatives."""
    return angles[:, ::-1] * [-1.0, 1.0, 1.0]


def make_rotation(angles: Array) -> Array:
    """Return the matrices, shape (samples, 3, 3), of angles in rad, shape (samples, 3).

    scipy's `Rotation.from_euler` gives the same in six times the time.
    """
    (s, c), (st, ct), (sy, cy) = ((np.sin(a), np.cos(a)) for a in angles.T)
    rows = [
        [cy * ct, cy * st * s - sy * c, cy * st * c + sy * s],
        [sy * ct, sy * st * s + cy * c, sy * st * c - cy * s],
        [-st, ct * s, ct * c],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def find_angles(rotations: Array) -> Array:
    """Return roll, pitch and yaw, rad, shape (samples, 3), of rotation matrices (samples, 3, 3).

    Rolls and yaws are in [-pi, pi], pitches in [-pi/2, pi/2].
    """
    return np.asarray(Rotation.from_matrix(rotations).as_euler("ZYX")[:, ::-1])


def find_body_rates(angles: Array, rates: Array) -> Array:
    """Return the angular velocities w in the body's frame, rad/s, of angles, rad, and rates, rad/s.

    All have the shape (samples, 3). Exact: R' = R [w]x (Mehammer et al. 2018, Eq. 2, inverted).
    """
    phi, theta, _ = angles.T
    roll, pitch, yaw = rates.T
    return np.column_stack(
        [
            roll - np.sin(theta) * yaw,
            np.cos(phi) * pitch + np.sin(phi) * np.cos(theta) * yaw,
            -np.sin(phi) * pitch + np.cos(phi) * np.cos(theta) * yaw,
        ]
    )


def find_angle_rates(angles: Array, body_rates: Array) -> Array:
    """Return the derivatives of angles, rad/s, of body rates, rad/s: Mehammer et al. (2018), Eq. 2.

    All have the shape (samples, 3); angles are in rad.
    """
    phi, theta, _ = angles.T
    p, q, r = body_rates.T
    turned = np.sin(phi) * q + np.cos(phi) * r
    return np.column_stack(
        [p + np.tan(theta) * turned, np.cos(phi) * q - np.sin(phi) * r, turned / np.cos(theta)]
    )


def find_body_acceleration(angles: Array, rates: Array, second: Array) -> Array:
    """Return the angular accelerations w' in the body's frame, rad/s^2, shape (samples, 3).

    They are the exact derivatives of `find_body_rates`. The arguments are angles, rad, and their
    first and second derivatives, rad/s and rad/s^2, shape (samples, 3) each.
    """
    # Each of the three turns carries the axes of those before it: seen from the body, these
    # change by minus the cross product.
    of_roll, of_pitch, of_yaw = (find_body_rates(angles, rates * axis) for axis in np.eye(3))
    carried = np.cross(of_roll, of_pitch) + np.cross(of_roll + of_pitch, of_yaw)
    return np.asarray(find_body_rates(angles, second) - carried)
