"""Compiled strapdown navigation of a rigid body: state, errors, how both move and are corrected.

States are position p and velocity v in a frame at rest, attitude R (a unit quaternion that turns
vectors of the body into this frame), the bias b of the accelerometers, and c, which says how the
body turns. With the measured specific force f:

    p' = v,   v' = R (f - b - noise) + g e_z,   R' = R [w]x,   b' = noise,   c' = noise

There are two models of g and w (`Model`). With `GYROSCOPES`, z points up, and the measured angular
velocity turns the body; c is the gyroscopes' bias. With `RATE_AS_STATE`, z points down, c is w
itself, and gyroscopes measure it.

Errors (dp, dv, da, db, dc) have R_true = R Exp([da]x) (Sola 2017, Quaternion kinematics for the
error-state Kalman filter, chapters 5 and 6; Markley 2003, Attitude error representations for Kalman
filtering). Earth's rotation, .0042 deg/s, is left out. It is constant in the frame, so a bias of
the gyroscopes takes it up while the heading stays, but only if as large a bias is assumed: not that
of a fibre-optic or tactical unit (docs/blade.md).

State vectors have 16 elements: p, v, quaternion (scalar first), b, c. Errors have 15. More may
stand behind them: what moves a state lets them stand, what corrects it corrects them, too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import find_turn, lean, rotate, turn
from owtsweep.gravity import GRAVITY

#: Number of states and of errors.
STATES, ERRORS = 16, 15


class Model(NamedTuple):
    """The acceleration of gravity along z, and the sign with which c adds to a given rate."""

    gravity: float
    sign: float


GYROSCOPES, RATE_AS_STATE = Model(-GRAVITY, -1.0), Model(GRAVITY, 1.0)


class Record(NamedTuple):
    """What filters get that are corrected by GNSS fixes.

    fixes: positions of antennas at samples, shape (steps, antennas, 3), NaN where none is.
    levers: where the antennas are from the inertial unit, in the body's frame, shape (antennas, 3).
    variance: of the noise of a fix at each sample, shape (steps, 3).
    due: whether a fix is due at a sample, lost or not, shape (steps,).
    force, rate: specific force and angular velocity of the body, shape (steps, 3) each.
    step: sampling interval in s.
    noise: as of `add_noise`, shape (4,).
    """

    fixes: Array
    levers: Array
    variance: Array
    due: NDArray[np.bool_]
    force: Array
    rate: Array
    step: float
    noise: Array


@njit
def move(s, d, force, next_force, rate, model, old, new):
    """Move the state s (16,) by d seconds, in place.

    force, next_force: specific force at the beginning and the end, linear between them, shape (3,).
    rate: mean of the measured angular velocity, shape (3,); 0 if c is the angular velocity.
    old, new: filled with the attitude's matrices (3, 3) at the beginning and the end.
    """
    rotate(s[6:10], old)
    turn(
        s[6:10],
        d * (rate[0] + model.sign * s[13]),
        d * (rate[1] + model.sign * s[14]),
        d * (rate[2] + model.sign * s[15]),
    )
    rotate(s[6:10], new)
    for i in range(3):
        begin, end = 0.0, 0.0
        for k in range(3):
            begin += old[i, k] * (force[k] - s[10 + k])
            end += new[i, k] * (next_force[k] - s[10 + k])
        if i == 2:
            begin += model.gravity
            end += model.gravity
        s[i] += d * s[3 + i] + d * d * (begin / 3.0 + end / 6.0)
        s[3 + i] += 0.5 * d * (begin + end)


@njit
def linearise(s, force, next_force, old, new, M, R, back):
    """Write by what errors change over a step; arguments are those of `move`.

    `M`, `R` and `back` are filled, (3, 3): change of the acceleration with da, the mean attitude,
    and the turn of the body back by its own rotation.
    """
    lean(old, force - s[10:13], M)
    lean(new, next_force - s[10:13], R)
    for i in range(3):
        for j in range(3):
            M[i, j] = 0.5 * (M[i, j] + R[i, j])
            R[i, j] = 0.5 * (old[i, j] + new[i, j])
            back[i, j] = new[0, i] * old[0, j] + new[1, i] * old[1, j] + new[2, i] * old[2, j]


@njit
def carry(P, d, M, R, back, model):
    """Carry the columns of P (15 or more, n), errors, over d seconds, in place: F P."""
    a, turned = np.empty(3), np.empty(3)
    for j in range(P.shape[1]):
        for i in range(3):
            a[i] = 0.0
            turned[i] = model.sign * d * P[12 + i, j]
            for k in range(3):
                a[i] += M[i, k] * P[6 + k, j] - R[i, k] * P[9 + k, j]
                turned[i] += back[i, k] * P[6 + k, j]
        for i in range(3):
            P[i, j] += d * P[3 + i, j] + 0.5 * d * d * a[i]
            P[3 + i, j] += d * a[i]
            P[6 + i, j] = turned[i]


@njit
def predict(s, P, d, force, next_force, rate, model):
    """Predict s (16 or more,) and P by d seconds without noise, in place; see `move`.

    States and errors behind the first stay as they are.
    """
    old, new = np.empty((3, 3)), np.empty((3, 3))
    M, R, back = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    move(s[:STATES], d, force, next_force, rate, model, old, new)
    linearise(s, force, next_force, old, new, M, R, back)
    carry(P, d, M, R, back, model)
    carry(P.T, d, M, R, back, model)
    mirror(P)


@njit
def mirror(P):
    """Make P symmetric again, in place, by its upper half.

    What rounding adds to its skew part no measurement takes away again, and F carries it on: in an
    hour it would outgrow P.
    """
    for i in range(len(P)):
        for j in range(i):
            P[i, j] = P[j, i]


@njit
def drive(P, x, v, W, d):
    """Add to P what white noise of the intensity W in v' does over d seconds, where x' = v."""
    P[x, x] += W * d * d * d / 3.0
    P[x, v] += W * d * d / 2.0
    P[v, x] += W * d * d / 2.0
    P[v, v] += W * d


@njit
def add_noise(P, d, noise):
    """Add to P the noise of d seconds, in place, where gyroscopes are measured and c is their bias.

    `noise` (4,): intensities of the noise of accelerometers and gyroscopes, variance of a sample
    times its interval, and changes of the variance of their biases per second.
    """
    for i in range(3):
        drive(P, i, 3 + i, noise[0], d)
        P[6 + i, 6 + i] += noise[1] * d
        P[9 + i, 9 + i] += noise[2] * d
        P[12 + i, 12 + i] += noise[3] * d


@njit
def place(s, R, lever, out):
    """Write into `out` (3,) where a point of the body is, `lever` (3,) from the inertial unit."""
    for i in range(3):
        out[i] = s[i] + R[i, 0] * lever[0] + R[i, 1] * lever[1] + R[i, 2] * lever[2]


@njit
def learn(P, dx, row, e, variance):
    """Correct by an innovation; return its square over its variance.

    P, dx: covariance (n, n) and the error found so far (n,); both are changed in place.
    row: by what each error enters the measurement, shape (n,).
    e, variance: the innovation before any correction, and the variance of the measurement's noise.
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
    root = np.sqrt(S)
    e /= root
    for i in range(n):
        column[i] /= root
        dx[i] += column[i] * e
    for i in range(n):
        for j in range(n):
            P[i, j] -= column[i] * column[j]
    return e * e


@njit
def correct(s, dx):
    """Put the errors dx (15 or more,) into the state s (one element longer), in place."""
    for i in range(6):
        s[i] += dx[i]
    turn(s[6:10], dx[6], dx[7], dx[8])
    for i in range(9, len(dx)):
        s[i + 1] += dx[i]


@njit
def subtract(s, base, dx):
    """Write into dx (15,) the errors that lead from the state `base` to the state s."""
    for i in range(6):
        dx[i] = s[i] - base[i]
    find_turn(base[6:10], s[6:10], dx[6:9])
    for i in range(9, ERRORS):
        dx[i] = s[i + 1] - base[i + 1]
