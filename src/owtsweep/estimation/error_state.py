"""The compiled error-state Kalman filter of a rigid body with a quaternion attitude.

States are position p and velocity v in a frame at rest, attitude R (a unit quaternion that turns
vectors of the body into this frame), angular velocity w and accelerometer bias b in the body's
frame. With the specific force f and gravity g e_z, z pointing down:

    p' = v,   v' = R (f - b - noise) + g e_z,   R' = R [w]x,   w' = noise,   b' = noise

The gyroscopes measure w at each sample; positions and Euler angles are reported, perhaps late. The
filter's covariance is that of the errors (dp, dv, da, dw, db) with R_true = R Exp([da]x) (Sola
2017, Quaternion kinematics for the error-state Kalman filter, chapters 5 and 6; Markley 2003,
Attitude error representations for Kalman filtering). Times are in samples, as in `kinematic`.

State vectors have 16 elements: p, v, quaternion (scalar first), w, b. Errors have 15.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.gravity import GRAVITY

#: Number of states and of errors.
STATES, ERRORS = 16, 15


@njit
def rotate(q, R):
    """Write the matrix of the unit quaternion q (4,) into R (3, 3)."""
    w, x, y, z = q
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@njit
def turn(q, x, y, z):
    """Turn the quaternion q (4,) by the rotation vector (x, y, z) of the body's frame, in place."""
    angle = np.sqrt(x * x + y * y + z * z)
    half = 0.5 * np.sinc(0.5 * angle / np.pi)
    a, b, c, d = np.cos(0.5 * angle), half * x, half * y, half * z
    w, i, j, k = q
    q[0] = w * a - i * b - j * c - k * d
    q[1] = w * b + i * a + j * d - k * c
    q[2] = w * c - i * d + j * a + k * b
    q[3] = w * d + i * c - j * b + k * a
    q /= np.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)


@njit
def find_angles(q, angles):
    """Write roll, pitch, yaw (turned in the order yaw, pitch, roll) of q into `angles` (3,)."""
    w, x, y, z = q
    angles[0] = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    angles[1] = np.arcsin(min(max(2 * (w * y - z * x), -1.0), 1.0))
    angles[2] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


@njit
def find_quaternion(angles, q):
    """Write the quaternion of roll, pitch, yaw into q (4,)."""
    q[:] = 0.0
    q[0] = 1.0
    turn(q, 0.0, 0.0, angles[2])
    turn(q, 0.0, angles[1], 0.0)
    turn(q, angles[0], 0.0, 0.0)


@njit
def map_rates(angles, T):
    """Write into T (3, 3) what turns body rates into those of roll, pitch, yaw (Fossen 2011, 2.2).

    It also turns a small rotation of the body's frame into changes of the angles.
    """
    s, c = np.sin(angles[0]), np.cos(angles[0])
    t, k = np.tan(angles[1]), np.cos(angles[1])
    T[0, 0], T[0, 1], T[0, 2] = 1.0, s * t, c * t
    T[1, 0], T[1, 1], T[1, 2] = 0.0, c, -s
    T[2, 0], T[2, 1], T[2, 2] = 0.0, s / k, c / k


@njit
def push(s, P, d, first, last, noise):
    """Predict the state s (16,) and its covariance P (15, 15) by d seconds, in place.

    Parameters
    ----------
    first, last
        Specific force at the beginning and the end, linear between them, shape (3,).
    noise
        Intensities of the noise of accelerations, of angular accelerations and of the bias:
        variance of a sample times its interval, or change of the variance per second, shape (3, 3).
    """
    R, old, M = np.empty((3, 3)), np.empty((3, 3)), np.zeros((3, 3))
    rotate(s[6:10], old)
    turn(s[6:10], d * s[10], d * s[11], d * s[12])
    rotate(s[6:10], R)
    a, b = first - s[13:16], last - s[13:16]
    for i in range(3):
        begin = old[i, 0] * a[0] + old[i, 1] * a[1] + old[i, 2] * a[2]
        end = R[i, 0] * b[0] + R[i, 1] * b[1] + R[i, 2] * b[2]
        if i == 2:
            begin += GRAVITY
            end += GRAVITY
        s[i] += d * s[3 + i] + d * d * (begin / 3.0 + end / 6.0)
        s[3 + i] += 0.5 * d * (begin + end)
        # M = -R [f]x, the mean of both ends
        for turned, force in ((old, a), (R, b)):
            M[i, 0] -= 0.5 * (turned[i, 1] * force[2] - turned[i, 2] * force[1])
            M[i, 1] -= 0.5 * (turned[i, 2] * force[0] - turned[i, 0] * force[2])
            M[i, 2] -= 0.5 * (turned[i, 0] * force[1] - turned[i, 1] * force[0])
    R = 0.5 * (R + old)
    back = np.empty((3, 3))
    inverse = np.array([1.0, 0.0, 0.0, 0.0])
    turn(inverse, -d * s[10], -d * s[11], -d * s[12])
    rotate(inverse, back)
    carry(P, d, M, R, back)
    carry(P.T, d, M, R, back)
    for i in range(3):
        W, U = noise[0, i] * d, noise[1, i] * d
        P[i, i] += W * d * d / 3.0
        P[i, 3 + i] += W * d / 2.0
        P[3 + i, i] += W * d / 2.0
        P[3 + i, 3 + i] += W
        P[6 + i, 6 + i] += U * d * d / 3.0
        P[6 + i, 9 + i] += U * d / 2.0
        P[9 + i, 6 + i] += U * d / 2.0
        P[9 + i, 9 + i] += U
        P[12 + i, 12 + i] += noise[2, i] * d


@njit
def carry(P, d, M, R, back):
    """Carry the columns of P (15, 15), errors, over d seconds, in place: F P.

    `M` is the change of the acceleration with the attitude, `R` the mean attitude, `back` the turn
    of the body back by its own rotation, (3, 3) each.
    """
    a = np.empty(3)
    turned = np.empty(3)
    for j in range(P.shape[1]):
        for i in range(3):
            a[i] = 0.0
            turned[i] = d * P[9 + i, j]
            for k in range(3):
                a[i] += M[i, k] * P[6 + k, j] - R[i, k] * P[12 + k, j]
                turned[i] += back[i, k] * P[6 + k, j]
        for i in range(3):
            P[i, j] += d * P[3 + i, j] + 0.5 * d * d * a[i]
            P[3 + i, j] += d * a[i]
            P[6 + i, j] = turned[i]


@njit
def learn(P, dx, row, e, variance):
    """Learn from an innovation; return its square over its variance.

    Parameters
    ----------
    P, dx
        Covariance (15, 15) and the error found so far (15,); both are changed in place.
    row
        By what each error enters the measurement, shape (15,).
    e, variance
        The innovation before any correction, and the variance of the measurement's noise.
    """
    n = len(dx)
    column = np.zeros(n)
    S = variance
    for j in range(n):
        if row[j] != 0.0:
            e -= row[j] * dx[j]
            for i in range(n):
                column[i] += P[i, j] * row[j]
    for j in range(n):
        S += row[j] * column[j]
    for i in range(n):
        gain = column[i] / S
        dx[i] += gain * e
        for j in range(n):
            P[i, j] -= gain * column[j]
    return e * e / S


@njit
def correct(s, dx):
    """Put the errors dx (15,) into the state s (16,), in place."""
    for i in range(6):
        s[i] += dx[i]
    turn(s[6:10], dx[6], dx[7], dx[8])
    for i in range(6):
        s[10 + i] += dx[9 + i]


@njit
def learn_rate(s, P, rate, variance):
    """Correct by the measured angular velocity (3,), whose noise has a `variance` (3,)."""
    dx, row = np.zeros(ERRORS), np.zeros(ERRORS)
    for i in range(3):
        row[9 + i] = 1.0
        learn(P, dx, row, rate[i] - s[10 + i], variance[i])
        row[9 + i] = 0.0
    correct(s, dx)


@njit
def learn_report(s, P, reported, ahead, variance, nis):
    """Correct by reported positions and Euler angles (6,), whose noise has a `variance` (6,).

    The report shows the motion `ahead` seconds after the state, 0 but for irregular reports. `nis`
    (6,) gets squared innovations over their variances, each given those before it.
    """
    dx, row, angles, T = np.zeros(ERRORS), np.zeros(ERRORS), np.empty(3), np.empty((3, 3))
    find_angles(s[6:10], angles)
    map_rates(angles, T)
    for i in range(3):
        row[i], row[3 + i] = 1.0, ahead
        e = reported[i] - s[i] - ahead * s[3 + i]
        nis[i] = learn(P, dx, row, e, variance[i])
        row[i], row[3 + i] = 0.0, 0.0
    for i in range(3):
        e = reported[3 + i] - angles[i]
        for k in range(3):
            row[6 + k], row[9 + k] = T[i, k], ahead * T[i, k]
            e -= ahead * T[i, k] * s[10 + k]
        # The same attitude has angles that differ by whole turns.
        e -= 2.0 * np.pi * np.round(e / (2.0 * np.pi))
        nis[3 + i] = learn(P, dx, row, e, variance[3 + i])
    correct(s, dx)


@njit
def advance(s, P, start, stop, force, rate, step, noise, rate_variance):
    """Predict s and P in place from the time `start` to `stop` (samples); learn rates between."""
    j = int(start)
    time = start
    while time < stop:
        end = min(j + 1.0, stop)
        slope = force[j + 1] - force[j]
        push(s, P, (end - time) * step, force[j] + (time - j) * slope, force[j] + (end - j) * slope,
             noise)  # fmt: skip
        j += 1
        time = end
        if end == j:
            learn_rate(s, P, rate[j], rate_variance)


@njit
def write(s, P, position, velocity, covariance):
    """Write positions and Euler angles (6,), their derivatives (6,), covariances (6, 2, 2)."""
    angles, T = np.empty(3), np.empty((3, 3))
    find_angles(s[6:10], angles)
    map_rates(angles, T)
    for i in range(3):
        position[i], velocity[i] = s[i], s[3 + i]
        covariance[i, 0, 0], covariance[i, 0, 1] = P[i, i], P[i, 3 + i]
        covariance[i, 1, 0], covariance[i, 1, 1] = P[3 + i, i], P[3 + i, 3 + i]
        position[3 + i], velocity[3 + i] = angles[i], 0.0
        covariance[3 + i] = 0.0
        for k in range(3):
            velocity[3 + i] += T[i, k] * s[10 + k]
            for m in range(3):
                both = T[i, k] * T[i, m]
                covariance[3 + i, 0, 0] += both * P[6 + k, 6 + m]
                covariance[3 + i, 0, 1] += both * P[6 + k, 9 + m]
                covariance[3 + i, 1, 1] += both * P[9 + k, 9 + m]
        covariance[3 + i, 1, 0] = covariance[3 + i, 0, 1]


@njit
def filter_body(reported, shown, force, rate, step, noise, variances, first, start, found):
    """Filter a record in the order in which reports arrive.

    Parameters
    ----------
    reported, shown
        Positions and Euler angles by arrival, shape (steps, 6), NaN where none arrives, and the
        times in samples that they show, shape (steps,).
    force, rate
        Specific force and angular velocity of the body, shape (steps, 3) each.
    step
        Sampling interval in s.
    noise
        As of `push`.
    variances
        Of reports (6,) and of rates (3,).
    first, start
        The sample at which the first report arrives that is used; the state (16,) and covariance
        (15, 15) at the time that it shows, with this report; both are overwritten.
    found
        Positions (steps, 6), velocities (steps, 6), covariances (steps, 6, 2, 2), squared
        innovations over their variances (steps, 6); filled from the sample `first` on.
    """
    position, velocity, covariance, nis = found
    of_report, of_rate = variances
    kept, kept_P = start
    known = shown[first]
    s, P = kept.copy(), kept_P.copy()
    advance(s, P, known, float(first), force, rate, step, noise, of_rate)
    write(s, P, position[first], velocity[first], covariance[first])
    for k in range(first + 1, len(reported)):
        if np.isnan(reported[k, 0]):
            advance(s, P, k - 1.0, float(k), force, rate, step, noise, of_rate)
        else:
            time = min(max(shown[k], known), float(k))
            if time >= k - 1.0:  # nothing between: what is known now is all that is known
                kept[:], kept_P[:], known = s, P, k - 1.0
            advance(kept, kept_P, known, time, force, rate, step, noise, of_rate)
            ahead = (shown[k] - time) * step
            learn_report(kept, kept_P, reported[k], ahead, of_report, nis[k])
            known = time
            s[:], P[:] = kept, kept_P
            advance(s, P, known, float(k), force, rate, step, noise, of_rate)
        write(s, P, position[k], velocity[k], covariance[k])
