"""The attitude of a rigid body in compiled kernels: a unit quaternion, scalar first.

It turns vectors of the body into the frame at rest. A small rotation vector a of the body's frame
changes the matrix R to R Exp([a]x) (Sola 2017, Quaternion kinematics for the error-state Kalman
filter, chapter 4). Where no kernel needs it, the package takes scipy's `Rotation`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit


@njit
def rotate(q, R):
    """Write the matrix of the unit quaternion q (4,) into R (3, 3)."""
    w, x, y, z = q
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@njit
def multiply(w, i, j, k, a, b, c, d):
    """Return the product of the quaternions (w, i, j, k) and (a, b, c, d)."""
    return (
        w * a - i * b - j * c - k * d,
        w * b + i * a + j * d - k * c,
        w * c - i * d + j * a + k * b,
        w * d + i * c - j * b + k * a,
    )


@njit
def turn(q, x, y, z):
    """Turn the quaternion q (4,) by the rotation vector (x, y, z) of the body's frame, in place."""
    angle = np.sqrt(x * x + y * y + z * z)
    half = 0.5 * np.sinc(0.5 * angle / np.pi)
    w, i, j, k = q
    q[0], q[1], q[2], q[3] = multiply(w, i, j, k, np.cos(0.5 * angle), half * x, half * y, half * z)
    q /= np.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)


@njit
def find_turn(base, q, a):
    """Write into a (3,) the rotation vector that turns the quaternion `base` to q, (4,) each."""
    w, x, y, z = multiply(base[0], -base[1], -base[2], -base[3], q[0], q[1], q[2], q[3])
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    size = np.sqrt(x * x + y * y + z * z)
    factor = 2.0 * np.arctan2(size, w) / size if size > 1e-12 else 2.0
    a[0], a[1], a[2] = factor * x, factor * y, factor * z


@njit
def lean(R, v, H):
    """Write into H (3, 3) by how much R v changes with a rotation vector of the body: -R [v]x."""
    for i in range(3):
        H[i, 0] = R[i, 2] * v[1] - R[i, 1] * v[2]
        H[i, 1] = R[i, 0] * v[2] - R[i, 2] * v[0]
        H[i, 2] = R[i, 1] * v[0] - R[i, 0] * v[1]


@njit
def read_angles(q, angles, T):
    """Write roll, pitch and yaw of q into `angles` (3,), and their rates' matrix into T (3, 3).

    T turns body rates into rates of the angles (Fossen 2011, section 2.2), and small rotation
    vectors of the body into changes of the angles.
    """
    w, x, y, z = q
    angles[0] = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    angles[1] = np.arcsin(min(max(2 * (w * y - z * x), -1.0), 1.0))
    angles[2] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    s, c = np.sin(angles[0]), np.cos(angles[0])
    t, k = np.tan(angles[1]), np.cos(angles[1])
    T[0, 0], T[0, 1], T[0, 2] = 1.0, s * t, c * t
    T[1, 0], T[1, 1], T[1, 2] = 0.0, c, -s
    T[2, 0], T[2, 1], T[2, 2] = 0.0, s / k, c / k
