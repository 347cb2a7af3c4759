"""The compiled error-state Kalman filter of a rigid body whose position and attitude are reported.

The gyroscopes measure the angular velocity w, a state, at each sample (`strapdown.RATE_AS_STATE`);
positions and Euler angles are reported, perhaps late. Angular accelerations are nothing but noise,
w' = noise. Times are in samples, as in `kinematic`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import read_angles
from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    RATE_AS_STATE,
    correct,
    drive,
    learn,
    predict,
)


@njit
def push(s, P, d, first, last, noise):
    """Predict the state s (16,) and its covariance P (15, 15) by d seconds, in place.

    first, last: specific force at the beginning and the end, linear between them, shape (3,).
    noise: intensities of the noise of accelerations, of angular accelerations and of the bias:
        variance of a sample times its interval, or change of the variance per second, shape (3, 3).
    """
    predict(s, P, d, first, last, np.zeros(3), RATE_AS_STATE)
    for i in range(3):
        drive(P, i, 3 + i, noise[0, i], d)
        drive(P, 6 + i, 12 + i, noise[1, i], d)
        P[9 + i, 9 + i] += noise[2, i] * d


@njit
def learn_rate(s, P, rate, variance):
    """Correct by the measured angular velocity (3,), whose noise has a `variance` (3,)."""
    dx, row = np.zeros(ERRORS), np.zeros(ERRORS)
    for i in range(3):
        row[12 + i] = 1.0
        learn(P, dx, row, rate[i] - s[13 + i], variance[i])
        row[12 + i] = 0.0
    correct(s, dx)


@njit
def learn_report(s, P, reported, ahead, variance, nis):
    """Correct by reported positions and Euler angles (6,), whose noise has a `variance` (6,).

    The report shows the motion `ahead` seconds after the state, 0 but for irregular reports. `nis`
    (6,) gets squared innovations over their variances, each given those before it.
    """
    dx, row, angles, T = np.zeros(ERRORS), np.zeros(ERRORS), np.empty(3), np.empty((3, 3))
    read_angles(s[6:10], angles, T)
    for i in range(3):
        row[i], row[3 + i] = 1.0, ahead
        e = reported[i] - s[i] - ahead * s[3 + i]
        nis[i] = learn(P, dx, row, e, variance[i])
        row[i], row[3 + i] = 0.0, 0.0
    for i in range(3):
        e = reported[3 + i] - angles[i]
        for k in range(3):
            row[6 + k], row[12 + k] = T[i, k], ahead * T[i, k]
            e -= ahead * T[i, k] * s[13 + k]
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
    read_angles(s[6:10], angles, T)
    position[:3], position[3:] = s[:3], angles
    velocity[:3], velocity[3:] = s[3:6], 0.0
    covariance[3:] = 0.0
    for i in range(3):
        covariance[i, 0, 0], covariance[i, 0, 1] = P[i, i], P[i, 3 + i]
        covariance[i, 1, 0], covariance[i, 1, 1] = P[3 + i, i], P[3 + i, 3 + i]
        for k in range(3):
            velocity[3 + i] += T[i, k] * s[13 + k]
            for m in range(3):
                both = T[i, k] * T[i, m]
                covariance[3 + i, 0, 0] += both * P[6 + k, 6 + m]
                covariance[3 + i, 0, 1] += both * P[6 + k, 12 + m]
                covariance[3 + i, 1, 1] += both * P[12 + k, 12 + m]
        covariance[3 + i, 1, 0] = covariance[3 + i, 0, 1]


@njit
def filter_body(reported, shown, force, rate, step, noise, variances, first, start, found):
    """Filter a record in the order in which reports arrive.

    reported, shown: positions and Euler angles by arrival, shape (steps, 6), NaN where none
        arrives, and the times in samples that they show, shape (steps,).
    force, rate: specific force and angular velocity of the body, shape (steps, 3) each.
    step: sampling interval in s.
    noise: as of `push`, shape (3, 3).
    variances: of reports (6,) and of rates (3,).
    first: the sample at which the first report arrives that is used.
    start: the state (16,) and covariance (15, 15) at the time that this report shows, with this
        report; both are overwritten.
    found: positions (steps, 6), velocities (steps, 6), covariances (steps, 6, 2, 2), squared
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
