"""The Kalman predictors of Mehammer et al. (2018), time-varying and steady, as printed.

Each degree of freedom has the state X = [position, velocity] and the acceleration as input, held
constant over a step h (Eq. 9). Written out, with the gain K that holds A_d (Eqs. 11, 12, 16, 17):

    X(k+1|k) = A_d X(k|k-1) + B_d U(k) + K(k) (Y(k) - C_d X(k|k-1))
    P(k+1) = A_d (P - P C_d' (R + C_d P C_d')^-1 C_d P) A_d' + Q                        (14)

Eq. 9 prints G_d = I. A process noise v_1 that enters x' with G = I (Eq. 7) and is held over a step
enters X by G_d = [[h I, h^2/2 I], [0, h I]]; so it is here, in `make_noise`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit

#: Errors of the steady predictor fade if its closed loop's radius is this far below 1.
FADING = 1e-6


def make_transition(step: float) -> Array:
    """Return A_d of Eq. (9) for one degree of freedom, shape (2, 2); `step` in s."""
    return np.array([[1.0, step], [0.0, 1.0]])


def make_noise(step: float, sigma: Array) -> Array:
    """Return Q = G_d diag(sigma^2) G_d' for one degree of freedom, shape (2, 2).

    `sigma` (2,): standard deviations of the noise on the derivatives of position and velocity.
    """
    G = np.array([[step, 0.5 * step**2], [0.0, step]])
    return np.asarray((G * sigma**2) @ G.T)


def solve_steady(A: Array, C: Array, Q: Array, R: Array) -> tuple[Array, Array]:
    """Return the steady gain and covariance of Eqs. (17) and (18), shapes (2, m) and (2, 2).

    A, C: A_d (2, 2) and C_d (m, 2) for one degree of freedom.
    Q, R: covariances of the noise of process (2, 2) and measurement (m, m).
    Raises LinAlgError if there is no steady state, as without process noise.
    """
    from scipy.linalg import solve_discrete_are

    # In units of a report's noise and a step, numbers do not depend on the size of the motion.
    unit = np.sqrt(R[0, 0]) * np.array([1.0, 1.0 / A[0, 1]])
    scaled = A * unit / unit[:, None]
    outputs = np.sqrt(np.diag(R))
    H = C * unit / outputs[:, None]
    P = solve_discrete_are(
        scaled.T, H.T, Q / np.outer(unit, unit), R / np.outer(outputs, outputs)
    ) * np.outer(unit, unit)
    P = 0.5 * (P + P.T)
    gain = A @ P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
    if np.abs(np.linalg.eigvals(A - gain @ C)).max() > 1.0 - FADING:
        raise np.linalg.LinAlgError("errors of the steady predictor do not fade")
    return np.asarray(gain), np.asarray(P)


@njit
def predict_steady(position, acceleration, rate, step, gain, variance, start, found):
    """Run the predictor of Eq. (16) over a record of one degree of freedom.

    position: reported positions, shape (steps,); a NaN is left out.
    acceleration, rate: measured acceleration, shape (steps,), and rate, shape (steps,) or (0,).
    step: sampling interval in s.
    gain: the columns of position and rate, shape (2, 2); the second is not read without rates.
    variance: variance of a position's innovation.
    start: position and velocity at sample 0, before its measurements, shape (2,).
    found: estimates (steps, 2), and squared innovations of positions over their variance, (steps,);
        overwritten.
    """
    estimate, nis = found
    p, v = start
    for k in range(len(position)):
        estimate[k, 0], estimate[k, 1] = p, v
        e = position[k] - p
        f = rate[k] - v if len(rate) else 0.0
        nis[k] = e * e / variance
        e = 0.0 if np.isnan(e) else e
        f = 0.0 if np.isnan(f) else f
        a = acceleration[k]
        p = p + step * v + 0.5 * step * step * a + gain[0, 0] * e + gain[0, 1] * f
        v = v + step * a + gain[1, 0] * e + gain[1, 1] * f


@njit
def predict_varying(position, acceleration, rate, step, Q, R, factor, start, P, found):
    """Run the predictor of Eqs. (11) to (14); parameters that `predict_steady` has not:

    Q: covariance of the process noise, shape (2, 2).
    R: variances of the noise of position and rate, shape (2,).
    factor: by what R is multiplied at each sample, shape (steps,).
    P: covariance of `start`, shape (2, 2).
    found: as there, with covariances (steps, 2, 2) in second place; overwritten.
    """
    estimate, covariance, nis = found
    p, v = start
    pp, pv, vv = P[0, 0], P[0, 1], P[1, 1]
    for k in range(len(position)):
        estimate[k, 0], estimate[k, 1] = p, v
        covariance[k, 0, 0], covariance[k, 0, 1] = pp, pv
        covariance[k, 1, 0], covariance[k, 1, 1] = pv, vv
        nis[k] = np.nan
        # Position and rate one after the other: with independent noise, this is their joint gain.
        if not np.isnan(position[k]):
            e = position[k] - p
            S = pp + factor[k] * R[0]
            nis[k] = e * e / S
            kp, kv = pp / S, pv / S
            p, v = p + kp * e, v + kv * e
            vv = vv - kv * pv
            pp, pv = pp - kp * pp, pv - kp * pv
        if len(rate) and not np.isnan(rate[k]):
            f = rate[k] - v
            S = vv + factor[k] * R[1]
            kp, kv = pv / S, vv / S
            p, v = p + kp * f, v + kv * f
            pp = pp - kp * pv
            pv, vv = pv - kp * vv, vv - kv * vv
        a = acceleration[k]
        p = p + step * v + 0.5 * step * step * a
        v = v + step * a
        pp = pp + 2.0 * step * pv + step * step * vv + Q[0, 0]
        pv = pv + step * vv + Q[0, 1]
        vv = vv + Q[1, 1]
