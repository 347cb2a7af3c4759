"""The compiled unscented Kalman filter of inertial navigation, corrected by GNSS fixes.

Its 15 errors are those of `strapdown`, its sigma points are errors put into the state (Crassidis
and Markley 2003, Unscented filtering for spacecraft attitude estimation; Brossard, Barrau and
Bonnabel 2020, A code for unscented Kalman filtering on manifolds). The weights are those of
kappa = 0: two points per error, root of 15 standard deviations out, and none in the middle.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import rotate
from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    GYROSCOPES,
    STATES,
    add_noise,
    correct,
    move,
    place,
    subtract,
)

#: Number of sigma points.
POINTS = 2 * ERRORS


@njit
def spread(s, P, points):
    """Write the sigma points of the state s and its covariance into `points` (30, 16)."""
    root = np.linalg.cholesky(P) * np.sqrt(float(ERRORS))
    for i in range(ERRORS):
        column = np.ascontiguousarray(root[:, i])
        points[i], points[ERRORS + i] = s, s
        correct(points[i], column)
        correct(points[ERRORS + i], -column)


@njit
def average(points, s, P, errors):
    """Write mean and covariance of sigma points into s (16,) and P; s is a state near the mean.

    `errors` (30, 15) gets the errors of the points from the mean.
    """
    for i in range(POINTS):
        subtract(points[i], s, errors[i])
    mean = np.zeros(ERRORS)
    for i in range(POINTS):
        mean += errors[i] / POINTS
    correct(s, mean)
    for i in range(POINTS):
        subtract(points[i], s, errors[i])
    P[:] = errors.T @ errors / POINTS


@njit
def learn_unscented(s, P, points, errors, fix, lever, variance):
    """Correct by the fix (3,) of an antenna, in place; return the normalised squared innovation.

    `points` and `errors` are room for sigma points.
    """
    spread(s, P, points)
    R, at = np.empty((3, 3)), np.empty((POINTS, 3))
    mean = np.zeros(3)
    for i in range(POINTS):
        subtract(points[i], s, errors[i])
        rotate(points[i, 6:10], R)
        place(points[i], R, lever, at[i])
        mean += at[i] / POINTS
    at -= mean
    S = at.T @ at / POINTS + np.diag(variance)
    cross = errors.T @ at / POINTS
    gain = np.linalg.solve(S, cross.T).T
    innovation = fix - mean
    correct(s, gain @ innovation)
    P -= gain @ cross.T
    P[:] = 0.5 * (P + P.T)
    return innovation @ np.linalg.solve(S, innovation)


@njit
def filter_unscented(record, start, found):
    """Filter a record; parameters are those of `multiplicative.filter_fixes`."""
    fixes, levers, variance, due, force, rate, step, noise = record
    s, P = start
    states, covariances, nis = found
    old, new = np.empty((3, 3)), np.empty((3, 3))
    points, errors = np.empty((POINTS, STATES)), np.empty((POINTS, ERRORS))
    for k in range(len(force)):
        if k > 0:
            spread(s, P, points)
            mean = 0.5 * (rate[k - 1] + rate[k])
            for i in range(POINTS):
                move(points[i], step, force[k - 1], force[k], mean, GYROSCOPES, old, new)
            move(s, step, force[k - 1], force[k], mean, GYROSCOPES, old, new)
            average(points, s, P, errors)
            add_noise(P, step, noise)
        if due[k]:
            for antenna in range(fixes.shape[1]):
                if not np.isnan(fixes[k, antenna, 0]):
                    nis[k] += learn_unscented(
                        s, P, points, errors, fixes[k, antenna], levers[antenna], variance[k]
                    )
        states[k], covariances[k] = s, P
