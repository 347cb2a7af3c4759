"""The compiled left-invariant extended Kalman filter of inertial navigation.

Position, velocity and attitude are one element of SE_2(3); their errors stand in the body's frame:
R_true = R Exp([da]x), v_true = v + R J dv, p_true = p + R J dp with the left Jacobian J of da
(Barrau and Bonnabel 2017, The invariant extended Kalman filter as a stable observer). Without
biases the errors then move the same whatever the motion is. Biases are as in `strapdown`, so
the filter is the "imperfect" one.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import lean, rotate, turn
from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    GYROSCOPES,
    add_noise,
    carry,
    learn,
    mirror,
    move,
    place,
)


@njit
def carry_body(P, d, force, back):
    """Carry the columns of P (15, n), errors in the body's frame, over d seconds, in place.

    They move as in a frame that is the body's own at the beginning, and then turn with the body.
    `force` (3,) is the mean specific force without its bias, `back` (3, 3) the turn of the body
    back by its own rotation.
    """
    M, still = np.empty((3, 3)), np.eye(3)
    lean(still, force, M)
    carry(P, d, M, still, back, GYROSCOPES)
    for j in range(P.shape[1]):
        for row in (0, 3):
            x, y, z = P[row, j], P[row + 1, j], P[row + 2, j]
            for i in range(3):
                P[row + i, j] = back[i, 0] * x + back[i, 1] * y + back[i, 2] * z


@njit
def correct_body(s, dx):
    """Put errors in the body's frame, dx (15,), into the state s (16,), in place."""
    R, A = np.empty((3, 3)), np.empty((3, 3))
    rotate(s[6:10], R)
    a = dx[6:9]
    angle = np.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    lean(np.eye(3), -a, A)  # [a]x
    if angle > 1e-6:
        J = (np.eye(3) + (1.0 - np.cos(angle)) / angle**2 * A
             + (angle - np.sin(angle)) / angle**3 * (A @ A))  # fmt: skip
    else:
        J = np.eye(3) + 0.5 * A
    T = R @ J
    s[0:3] += T @ np.ascontiguousarray(dx[0:3])
    s[3:6] += T @ np.ascontiguousarray(dx[3:6])
    turn(s[6:10], a[0], a[1], a[2])
    s[10:16] += dx[9:15]


@njit
def filter_invariant(record, start, found):
    """Filter a record; parameters are those of `multiplicative.filter_fixes`.

    Covariances, also that of the start, are those of errors in the body's frame.
    """
    fixes, levers, variance, due, force, rate, step, noise = record
    s, P = start
    states, covariances, nis = found
    old, new, H, at = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    dx, row = np.zeros(ERRORS), np.zeros(ERRORS)
    for k in range(len(force)):
        if k > 0:
            mean = 0.5 * (rate[k - 1] + rate[k])
            move(s, step, force[k - 1], force[k], mean, GYROSCOPES, old, new)
            felt, back = 0.5 * (force[k - 1] + force[k]) - s[10:13], new.T @ old
            carry_body(P, step, felt, back)
            carry_body(P.T, step, felt, back)
            mirror(P)
            add_noise(P, step, noise)
        if due[k]:
            dx[:] = 0.0
            rotate(s[6:10], new)
            for antenna in range(fixes.shape[1]):
                if np.isnan(fixes[k, antenna, 0]):
                    continue
                place(s, new, levers[antenna], at)
                lean(new, levers[antenna], H)
                for i in range(3):
                    row[0:3], row[6:9] = new[i], H[i]
                    nis[k] += learn(P, dx, row, fixes[k, antenna, i] - at[i], variance[k, i])
            correct_body(s, dx)
        states[k], covariances[k] = s, P
