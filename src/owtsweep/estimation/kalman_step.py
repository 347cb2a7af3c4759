"""Compute one step of the Kalman filter, for many series at once.

Sources: Kalman (1960); Anderson and Moore (1979), section 3.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError


def predict_covariance(P: Array, F: Array, Q: Array) -> Array:
    """Predict covariances P (..., n, n) of the state over one step: return F P F' + Q.

    F is the transition matrix (n, n), and Q is the covariance (n, n) of the process noise.
    """
    return np.asarray(F @ P @ F.T + Q)


def correct_covariance(
    P: Array, H: Array, R: Array, available: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Correct covariances of the state by a measurement, and compute the gain.

    Joseph's form (I - K H) P (I - K H)' + K R K' keeps the covariance symmetric and positive
    (Bucy and Joseph 1968). A component of the measurement that does not exist is given a zero row
    in H, and noise of variance 1 that is correlated with nothing. Then the component's column of K
    is zero, and the states are corrected exactly as if only the other components had been
    measured (Durbin and Koopman 2012, section 4.10).

    Parameters
    ----------
    P
        Covariances of the state before the measurement, shape (patterns, n, n). A pattern says
        which components of the measurement exist.
    H, R
        Measurement matrix (m, n), and covariance (m, m) of the measurement noise.
    available
        Shape (patterns, m): whether a component of the measurement exists.

    Returns
    -------
    K, S, corrected
        The gain P H' S^-1, shape (patterns, n, m); the innovation's covariance S = H P H' + R,
        shape (patterns, m, m); and the covariance of the state after the measurement, shape
        (patterns, n, n).

    Raises
    ------
    InputError
        If the innovation's covariance S is singular, because a component without noise measures
        something that is already known exactly.
    """
    there = available[:, :, None]
    H_there = np.where(there, H, 0.0)
    R_there = np.where(there & available[:, None, :], R, np.eye(len(R)))
    HP = H_there @ P
    S = HP @ transpose(H_there) + R_there
    try:
        K = transpose(np.linalg.solve(S, HP))
    except np.linalg.LinAlgError:
        raise InputError(
            "R: a measurement without noise repeats what is known exactly; give it some variance"
        ) from None
    rest = np.eye(P.shape[-1]) - K @ H_there
    corrected = rest @ P @ transpose(rest) + K @ np.where(there, R_there, 0.0) @ transpose(K)
    return K, S, 0.5 * (corrected + transpose(corrected))


def correct_state(x: Array, K: Array, innovation: Array) -> Array:
    """Return the states x corrected by the innovations e: x + K e, shape (series, n).

    The gains K have the shape (series, n, m), the innovations e (series, m). NaN in e counts as 0.
    """
    return x + multiply(K, np.nan_to_num(innovation))


def compute_nis(innovation: Array, innovation_covariance: Array) -> Array:
    """Compute the normalised innovation squared, e' S^-1 e, shape (...).

    `innovation` is e, shape (..., m); NaN in e counts as zero. `innovation_covariance` is S, shape
    (..., m, m).
    """
    e = np.nan_to_num(innovation)
    return np.asarray(np.sum(e * np.linalg.solve(innovation_covariance, e[..., None])[..., 0], -1))


def multiply(matrix: Array, vector: Array) -> Array:
    """Multiply matrices (..., n, m) by vectors (..., m); return vectors (..., n)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


def transpose(matrix: Array) -> Array:
    """Transpose matrices of shape (..., n, m); the result has the shape (..., m, n)."""
    return np.swapaxes(matrix, -1, -2)
