"""Heading, pitch and roll of a hanging blade, and its rotation matrix and body rates.

The frame is that of Maes et al. (2018), Fig. 2: x along the blade, z up. The heading psi is
positive clockwise seen from above, that is, about -z. The matrix turns vectors of the blade into
the frame at rest:

    R = T_psi T_theta T_phi = Rz(-psi) Ry(theta) Rx(phi)        (Eqs. 2 and 3)

In Eq. 3 the printed T_phi has a 1 in row 1, column 3. With it, T_phi is no rotation; it is 0 here.
Angles come in the order heading, pitch, roll.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require

#: Largest element of R^T R - 1 of what counts as a rotation matrix.
SKEWEST = 1e-6


def make_rotation(angles: Array) -> Array:
    """Return the rotation matrices, shape (samples, 3, 3), by Eq. 3.

    Parameters
    ----------
    angles
        Heading, pitch and roll, rad, shape (samples, 3).
    """
    psi, theta, phi = angles.T
    (s, c), (st, ct), (sp, cp) = ((np.sin(a), np.cos(a)) for a in (psi, theta, phi))
    rows = [
        [c * ct, c * st * sp + s * cp, c * st * cp - s * sp],
        [-s * ct, -s * st * sp + c * cp, -s * st * cp - c * sp],
        [-st, ct * sp, ct * cp],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def find_angles(rotations: Array) -> Array:
    """Return heading, pitch and roll, rad, shape (samples, 3), of rotation matrices.

    Headings and rolls are in [-pi, pi], pitches in [-pi/2, pi/2]. A matrix of NaN gives NaN. At a
    pitch of 90 degrees only a sum of heading and roll is defined; what is returned there gives the
    same matrix.

    Parameters
    ----------
    rotations
        Shape (samples, 3, 3).

    Raises
    ------
    InputError
        If a matrix is no rotation.
    """
    require_rotations(rotations)
    # Eqs. 9-11 take arccos, whose slope is infinite at 1: rounding of 1e-16 becomes 1e-8 rad where
    # the angle is near 0, and NaN where the quotient exceeds 1. The arctangent of both legs keeps
    # 1e-16 everywhere and needs no sign beside it.
    along, aside, down = rotations[:, 0, 0], -rotations[:, 1, 0], -rotations[:, 2, 0]
    psi = np.arctan2(aside, along)
    theta = np.arctan2(down, np.hypot(along, aside))
    # The second row of T_psi^T R is (0, cos(phi), -sin(phi)) at any pitch; its second element is
    # the numerator of Eq. 11.
    s, c = np.sin(psi), np.cos(psi)
    second = s[:, None] * rotations[:, 0] + c[:, None] * rotations[:, 1]
    return np.column_stack([psi, theta, np.arctan2(-second[:, 2], second[:, 1])])


def find_body_rates(angles: Array, rates: Array) -> Array:
    """Return the angular velocities w in the blade's frame, rad/s, shape (samples, 3).

    They are exact: R' = R [w]x. The heading counts clockwise, so its rate enters with the opposite
    sign of a yaw rate about z.

    Parameters
    ----------
    angles, rates
        Heading, pitch and roll, rad, and their derivatives, rad/s, shape (samples, 3) each.
    """
    _, theta, phi = angles.T
    heading, pitch, roll = rates.T
    (st, ct), (sp, cp) = ((np.sin(a), np.cos(a)) for a in (theta, phi))
    return np.column_stack(
        [
            roll + st * heading,
            cp * pitch - sp * ct * heading,
            -sp * pitch - cp * ct * heading,
        ]
    )


def find_body_acceleration(angles: Array, rates: Array, second: Array) -> Array:
    """Return the angular accelerations w' in the blade's frame, rad/s^2, shape (samples, 3).

    They are the exact time derivatives of `find_body_rates`.

    Parameters
    ----------
    angles, rates, second
        Heading, pitch and roll, rad, and their first and second derivatives, rad/s and rad/s^2,
        shape (samples, 3) each.
    """
    _, theta, phi = angles.T
    heading, pitch, roll = rates.T
    (st, ct), (sp, cp) = ((np.sin(a), np.cos(a)) for a in (theta, phi))
    # The rates enter linearly, so the second derivatives enter in the same way.
    turning = np.column_stack(
        [
            ct * pitch * heading,
            -sp * roll * pitch - (cp * ct * roll - sp * st * pitch) * heading,
            -cp * roll * pitch + (sp * ct * roll + cp * st * pitch) * heading,
        ]
    )
    return np.asarray(find_body_rates(angles, second) + turning)


def require_rotations(rotations: Array) -> None:
    """Raise an `InputError` unless each matrix is a rotation or has a NaN."""
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
