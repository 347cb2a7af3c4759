"""Compiled strapdown navigation of a rigid body: state, its errors, and how both move.

The frame at rest has z upwards. States are position p, velocity v, attitude R (a unit quaternion
that turns vectors of the body into this frame), and the biases of accelerometers and gyroscopes in
the body's frame. With the measured specific force f and angular velocity w:

    p' = v,   v' = R (f - ba) - g e_z,   R' = R [w - bg]x,   ba' = noise,   bg' = noise

Errors (dp, dv, da, dba, dbg) have R_true = R Exp([da]x) (Sola 2017, Quaternion kinematics for the
error-state Kalman filter, chapter 5). Earth's rotation, .0042 deg/s, is left out. It is constant in
the frame, so a bias of the gyroscopes takes it up while the heading stays, but only if as large a
bias is believed: not that of a fibre-optic or tactical unit (docs/blade.md, section 4).

State vectors have 16 elements: p, v, quaternion (scalar first), ba, bg. Errors have 15, and maybe
more behind them, which this module lets stand.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.error_state import rotate, turn
from owtsweep.gravity import GRAVITY

#: Number of states and of errors.
STATES, ERRORS = 16, 15


@njit
def move(s, d, force, rate, next_force, next_rate):
    """Move the state s (16,) by d seconds, in place.

    Specific force and rates (3,) are those at the beginning and the end, linear between them.
    """
    old, new = np.empty((3, 3)), np.empty((3, 3))
    rotate(s[6:10], old)
    turn(
        s[6:10],
        d * (0.5 * (rate[0] + next_rate[0]) - s[13]),
        d * (0.5 * (rate[1] + next_rate[1]) - s[14]),
        d * (0.5 * (rate[2] + next_rate[2]) - s[15]),
    )
    rotate(s[6:10], new)
    for i in range(3):
        begin, end = 0.0, 0.0
        for k in range(3):
            begin += old[i, k] * (force[k] - s[10 + k])
            end += new[i, k] * (next_force[k] - s[10 + k])
        if i == 2:
            begin -= GRAVITY
            end -= GRAVITY
        s[i] += d * s[3 + i] + d * d * (begin / 3.0 + end / 6.0)
        s[3 + i] += 0.5 * d * (begin + end)


@njit
def linearise(s, moved, d, force, next_force, M, R, back):
    """Write by what errors change over d seconds, at the states before and after `move`.

    Parameters
    ----------
    s, moved
        States (16,) at the beginning and the end.
    M, R, back
        Results (3, 3): change of the acceleration with da, the mean attitude, and the turn of the
        body back by its own rotation.
    """
    new = np.empty((3, 3))
    rotate(s[6:10], R)
    rotate(moved[6:10], new)
    for i in range(3):
        for j in range(3):
            back[i, j] = new[0, i] * R[0, j] + new[1, i] * R[1, j] + new[2, i] * R[2, j]
    a, b = force - s[10:13], next_force - s[10:13]
    for i in range(3):
        M[i, 0] = -0.5 * (R[i, 1] * a[2] - R[i, 2] * a[1] + new[i, 1] * b[2] - new[i, 2] * b[1])
        M[i, 1] = -0.5 * (R[i, 2] * a[0] - R[i, 0] * a[2] + new[i, 2] * b[0] - new[i, 0] * b[2])
        M[i, 2] = -0.5 * (R[i, 0] * a[1] - R[i, 1] * a[0] + new[i, 0] * b[1] - new[i, 1] * b[0])
    R[:] = 0.5 * (R + new)


@njit
def carry(P, d, M, R, back):
    """Carry the columns of P (15 or more, n), errors, over d seconds, in place: F P."""
    a, turned = np.empty(3), np.empty(3)
    for j in range(P.shape[1]):
        for i in range(3):
            a[i] = 0.0
            turned[i] = -d * P[12 + i, j]
            for k in range(3):
                a[i] += M[i, k] * P[6 + k, j] - R[i, k] * P[9 + k, j]
                turned[i] += back[i, k] * P[6 + k, j]
        for i in range(3):
            P[i, j] += d * P[3 + i, j] + 0.5 * d * d * a[i]
            P[3 + i, j] += d * a[i]
            P[6 + i, j] = turned[i]


@njit
def add_noise(P, d, noise):
    """Add to P the noise of d seconds, in place.

    `noise` (4,): intensities of the noise of accelerometers and gyroscopes, variance of a sample
    times its interval, and changes of the variance of their biases per second.
    """
    W = noise[0] * d
    for i in range(3):
        P[i, i] += W * d * d / 3.0
        P[i, 3 + i] += W * d / 2.0
        P[3 + i, i] += W * d / 2.0
        P[3 + i, 3 + i] += W
        P[6 + i, 6 + i] += noise[1] * d
        P[9 + i, 9 + i] += noise[2] * d
        P[12 + i, 12 + i] += noise[3] * d


@njit
def correct(s, dx):
    """Put the first 15 errors of dx into the state s (16,), in place."""
    for i in range(6):
        s[i] += dx[i]
    turn(s[6:10], dx[6], dx[7], dx[8])
    for i in range(6):
        s[10 + i] += dx[9 + i]


@njit
def subtract(s, base, dx):
    """Write into dx (15,) the errors that lead from the state `base` to the state s."""
    for i in range(6):
        dx[i] = s[i] - base[i]
    w, x, y, z = base[6], -base[7], -base[8], -base[9]
    a, b, c, e = s[6], s[7], s[8], s[9]
    q0 = w * a - x * b - y * c - z * e
    q1 = w * b + x * a + y * e - z * c
    q2 = w * c - x * e + y * a + z * b
    q3 = w * e + x * c - y * b + z * a
    if q0 < 0.0:
        q0, q1, q2, q3 = -q0, -q1, -q2, -q3
    size = np.sqrt(q1 * q1 + q2 * q2 + q3 * q3)
    factor = 2.0 * np.arctan2(size, q0) / size if size > 1e-12 else 2.0
    dx[6], dx[7], dx[8] = factor * q1, factor * q2, factor * q3
    for i in range(6):
        dx[9 + i] = s[10 + i] - base[10 + i]


@njit
def place(s, R, lever, out):
    """Write into `out` (3,) where a point of the body is, `lever` (3,) from the inertial unit."""
    for i in range(3):
        out[i] = s[i] + R[i, 0] * lever[0] + R[i, 1] * lever[1] + R[i, 2] * lever[2]


@njit
def lean(R, lever, H):
    """Write into H (3, 3) by how much a point at `lever` moves with da: -R [lever]x."""
    for i in range(3):
        H[i, 0] = -(R[i, 1] * lever[2] - R[i, 2] * lever[1])
        H[i, 1] = -(R[i, 2] * lever[0] - R[i, 0] * lever[2])
        H[i, 2] = -(R[i, 0] * lever[1] - R[i, 1] * lever[0])
