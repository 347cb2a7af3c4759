"""The compiled left-invariant extended Kalman filter of inertial navigation.

Position, velocity and attitude are one element of SE_2(3); their errors stand in the body's frame:
R_true = R Exp([da]x), v_true = v + R J dv, p_true = p + R J dp with the left Jacobian J of da
(Barrau and Bonnabel 2017, The invariant extended Kalman filter as a stable observer). Without
biases the errors then move the same whatever the motion is. Biases are as in `inertial`, so the
filter is the "imperfect" one.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.error_state import learn, rotate, turn
from owtsweep.estimation.inertial import ERRORS, add_noise, move, place


@njit
def cross_matrix(a, A):
    """Write the matrix of the cross product with a (3,) into A (3, 3)."""
    A[0, 0] = A[1, 1] = A[2, 2] = 0.0
    A[0, 1], A[0, 2], A[1, 2] = -a[2], a[1], -a[0]
    A[1, 0], A[2, 0], A[2, 1] = a[2], -a[1], a[0]


@njit
def carry_body(P, d, force, back):
    """Carry the columns of P (15, n), errors in the body's frame, over d seconds, in place.

    `force` (3,) is the mean specific force without its bias, `back` (3, 3) the turn of the body
    back by its own rotation.
    """
    p, v, a = np.empty(3), np.empty(3), np.empty(3)
    for j in range(P.shape[1]):
        x, y, z = P[6, j], P[7, j], P[8, j]
        # -[f]x da - dba
        a[0] = -(force[1] * z - force[2] * y) - P[9, j]
        a[1] = -(force[2] * x - force[0] * z) - P[10, j]
        a[2] = -(force[0] * y - force[1] * x) - P[11, j]
        for i in range(3):
            p[i] = P[i, j] + d * P[3 + i, j] + 0.5 * d * d * a[i]
            v[i] = P[3 + i, j] + d * a[i]
        for i in range(3):
            P[i, j] = back[i, 0] * p[0] + back[i, 1] * p[1] + back[i, 2] * p[2]
            P[3 + i, j] = back[i, 0] * v[0] + back[i, 1] * v[1] + back[i, 2] * v[2]
        for i in range(3):
            P[6 + i, j] = back[i, 0] * x + back[i, 1] * y + back[i, 2] * z - d * P[12 + i, j]


@njit
def correct_body(s, dx):
    """Put errors in the body's frame, dx (15,), into the state s (16,), in place."""
    R, A = np.empty((3, 3)), np.empty((3, 3))
    rotate(s[6:10], R)
    a = dx[6:9]
    angle = np.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    cross_matrix(a, A)
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
def filter_invariant(fixes, levers, variance, due, force, rate, step, noise, start, found):
    """Filter a record; parameters are those of `inertial_filter.filter_fixes`.

    Covariances, also that of the start, are those of errors in the body's frame.
    """
    s, P = start
    states, covariances, nis = found
    old, new, L, at = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    dx, row = np.zeros(ERRORS), np.zeros(ERRORS)
    for k in range(len(force)):
        if k > 0:
            rotate(s[6:10], old)
            mean = 0.5 * (force[k - 1] + force[k]) - s[10:13]
            move(s, step, force[k - 1], rate[k - 1], force[k], rate[k])
            rotate(s[6:10], new)
            back = new.T @ old
            carry_body(P, step, mean, back)
            carry_body(P.T, step, mean, back)
            add_noise(P, step, noise)
        if due[k]:
            dx[:] = 0.0
            rotate(s[6:10], new)
            for antenna in range(fixes.shape[1]):
                if np.isnan(fixes[k, antenna, 0]):
                    continue
                if np.isnan(nis[k]):
                    nis[k] = 0.0
                place(s, new, levers[antenna], at)
                cross_matrix(levers[antenna], L)
                tilt = new @ L
                for i in range(3):
                    row[:] = 0.0
                    row[0:3] = new[i]
                    row[6:9] = -tilt[i]
                    nis[k] += learn(P, dx, row, fixes[k, antenna, i] - at[i], variance[k, i])
            correct_body(s, dx)
        states[k], covariances[k] = s, P
