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

from owtsweep.arrays import Array
from owtsweep.errors import require

#: Largest element of R^T R - 1 of what counts as a rotation matrix.
SKEWEST = 1e-6


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

    Rolls and yaws are in [-pi, pi], pitches in [-pi/2, pi/2]. A matrix of NaN gives NaN. At a pitch
    of 90 degrees only a sum of yaw and roll is defined; what is returned there gives the same
    matrix, which scipy's angles do not within 1e-7 rad of it.

    Raises InputError if a matrix is no rotation.
    """
    require_rotations(rotations)
    # Maes et al. (2018), Eqs. 9-11, take arccos, whose slope is infinite at 1: rounding of 1e-16
    # becomes 1e-8 rad where the angle is near 0, and NaN where the quotient exceeds 1. The
    # arctangent of both legs keeps 1e-16 everywhere and needs no sign beside it.
    along, aside, down = rotations[:, 0, 0], rotations[:, 1, 0], -rotations[:, 2, 0]
    yaw = np.arctan2(aside, along)
    pitch = np.arctan2(down, np.hypot(along, aside))
    # The second row of Rz(yaw)^T R is (0, cos(roll), -sin(roll)) at any pitch; its second element
    # is the numerator of Eq. 11.
    s, c = np.sin(yaw), np.cos(yaw)
    second = c[:, None] * rotations[:, 1] - s[:, None] * rotations[:, 0]
    return np.column_stack([np.arctan2(-second[:, 2], second[:, 1]), pitch, yaw])


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


def require_rotations(rotations: Array) -> None:
    """Raise an `InputError` unless each matrix (samples, 3, 3) is a rotation or has a NaN."""
    require(
        rotations.ndim == 3 and rotations.shape[1:] == (3, 3),
        f"rotations: have shape {rotations.shape}; (samples, 3, 3) would work",
    )
    bad = np.asarray(np.isinf(rotations).any(axis=(1, 2)))
    known = np.isfinite(rotations).all(axis=(1, 2))
    R = rotations[known]
    skew = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2))
    bad[known] = (skew > SKEWEST) | (np.linalg.det(R) < 0.0)
    sample = int(np.argmax(bad)) if bad.any() else 0
    require(
        not bad.any(),
        f"rotations: matrix {sample} is no rotation; one with R^T R = 1 within {SKEWEST:g} and "
        "determinant +1 would work",
    )
