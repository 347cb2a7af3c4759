"""The compiled multiplicative Kalman filter of inertial navigation, corrected by GNSS fixes.

Errors are those of `strapdown`, with the attitude's error in the body's frame (Markley 2003,
Attitude error representations for Kalman filtering). Behind them may stand further states:

- the clock's offset tau: a fix with the time stamp t shows the antenna at t - tau, so a delay of
  fixes is the same state;
- by what the first antenna stands elsewhere on the body than assumed, three lengths;
- how the hook lets the body swing, nine states, m, its velocity, and c: the point on which the hook
  acts is at c + m, where m is an oscillator driven by white noise in each direction, and c wanders
  slowly. At each due time of a fix, lost or not, the filter takes as a measurement that this place
  and that of the inertial unit agree.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import lean, rotate
from owtsweep.estimation.inertial.strapdown import (
    GYROSCOPES,
    add_noise,
    correct,
    learn,
    mirror,
    place,
    predict,
)
from owtsweep.gravity import GRAVITY


@njit
def swing(s, P, at, transition, noise):
    """Predict the states of the swing, which begin at the error `at`, in place.

    `transition` and `noise` (3, 2, 2) are of m and its velocity; `noise` (3, 3, 3) has that of c in
    its last place.
    """
    x = at + 1  # a quaternion has one element more than its error
    for i in range(3):
        a, b = transition[i, 0]
        c, e = transition[i, 1]
        m, v = s[x + i], s[x + 3 + i]
        s[x + i], s[x + 3 + i] = a * m + b * v, c * m + e * v
        first, second = at + i, at + 3 + i
        for j in range(len(P)):
            m, v = P[first, j], P[second, j]
            P[first, j], P[second, j] = a * m + b * v, c * m + e * v
        for j in range(len(P)):
            m, v = P[j, first], P[j, second]
            P[j, first], P[j, second] = a * m + b * v, c * m + e * v
        P[first, first] += noise[i, 0, 0]
        P[first, second] += noise[i, 0, 1]
        P[second, first] += noise[i, 1, 0]
        P[second, second] += noise[i, 1, 1]
        P[at + 6 + i, at + 6 + i] += noise[i, 2, 2]
    mirror(P)


@njit
def learn_fix(s, P, dx, fix, assumed, variance, offset, astray, force, rate):
    """Correct by the fix (3,) of an antenna; return the innovation's square over its variance.

    `offset` is the place of the clock's offset among the errors, or -1, and `astray` that of the
    antenna's distance from its `assumed` lever (3,). `force` and `rate` (3,) are those of this
    sample. The result is the sum over three coordinates, each given those before.
    """
    R, H, at = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    row, lever = np.zeros(len(dx)), assumed.copy()
    if astray >= 0:
        lever += s[astray + 1 : astray + 4]
    rotate(s[6:10], R)
    lean(R, lever, H)
    place(s, R, lever, at)
    tau = s[offset + 1] if offset >= 0 else 0.0
    w, f = rate - s[13:16], force - s[10:13]
    turning = np.cross(w, lever)
    nis = 0.0
    for i in range(3):
        row[:] = 0.0
        row[i] = 1.0
        for k in range(3):
            row[6 + k] = H[i, k]
            if astray >= 0:
                row[astray + k] = R[i, k]
        e = fix[i] - at[i]
        if offset >= 0:
            velocity = s[3 + i]
            acceleration = -GRAVITY if i == 2 else 0.0
            for k in range(3):
                velocity += R[i, k] * turning[k]
                acceleration += R[i, k] * f[k]
            e += tau * velocity - 0.5 * tau * tau * acceleration
            row[3 + i] = -tau
            row[offset] = tau * acceleration - velocity
        nis += learn(P, dx, row, e, variance[i])
    return nis


@njit
def learn_swing(s, P, dx, lever, at, variance):
    """Correct by the fact that the point at `lever` (3,) is where the swing's states have it."""
    R, H, point = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    row = np.zeros(len(dx))
    rotate(s[6:10], R)
    lean(R, lever, H)
    place(s, R, lever, point)
    for i in range(3):
        row[:] = 0.0
        row[i] = 1.0
        for k in range(3):
            row[6 + k] = H[i, k]
        row[at + i] = row[at + 6 + i] = -1.0
        learn(P, dx, row, s[at + 1 + i] + s[at + 7 + i] - point[i], variance)


@njit
def filter_fixes(record, start, offset, astray, swinging, found):
    """Filter a `strapdown.Record`.

    start: state and covariance before the first fix; both are overwritten.
    offset, astray: places among the errors of the clock's offset and of the first antenna's
        distance from its lever, or -1.
    swinging: place of the swing's first error, or -1; lever of the point on which the hook acts,
        (3,); transition (3, 2, 2) and noise (3, 3, 3) of a sample; variance with which both agree.
    found: states (steps, n + 1) and covariances (steps, n, n), filled; squared innovations over
        their variance (steps,), to which those of a sample are added.
    """
    fixes, levers, variance, due, force, rate, step, noise = record
    s, P = start
    states, covariances, nis = found
    at, hook, transition, shaking, agreement = swinging
    dx = np.zeros(len(P))
    for k in range(len(force)):
        if k > 0:
            mean = 0.5 * (rate[k - 1] + rate[k])
            predict(s, P, step, force[k - 1], force[k], mean, GYROSCOPES)
            add_noise(P, step, noise)
            if at >= 0:
                swing(s, P, at, transition, shaking)
        if due[k]:
            dx[:] = 0.0
            for antenna in range(fixes.shape[1]):
                if not np.isnan(fixes[k, antenna, 0]):
                    nis[k] += learn_fix(
                        s, P, dx, fixes[k, antenna], levers[antenna], variance[k], offset,
                        astray if antenna == 0 else -1, force[k], rate[k],
                    )  # fmt: skip
            correct(s, dx)
            if at >= 0:
                dx[:] = 0.0
                learn_swing(s, P, dx, hook, at, agreement)
                correct(s, dx)
        states[k], covariances[k] = s, P
