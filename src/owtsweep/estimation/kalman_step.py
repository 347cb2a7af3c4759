"""One step of the Kalman filter, for many series at once.

Kalman (1960); Anderson and Moore (1979), section 3.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError


def predict_covariance(P: Array, F: Array, Q: Array) -> Array:
    """F P F' + Q for covariances (..., n, n)."""
    return np.asarray(F @ P @ F.T + Q)


def correct_covariance(
    P: Array, H: Array, R: Array, available: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Correct covariances by a measurement.

    Joseph's form (I - K H) P (I - K H)' + K R K' keeps the covariance symmetric and positive
    (Bucy and Joseph 1968). A lost component has a zero row in H and unit noise that is correlated
    with nothing. Its column of K is then zero, and the other components are corrected exactly as
    if its rows and columns were dropped (Durbin and Koopman 2012, section 4.10).

    Parameters
    ----------
    P
        (patterns, n, n) before the measurement.
    H, R
        (m, n) and (m, m).
    available
        (patterns, m): which components of the measurement exist.

    Returns
    -------
    K, S, corrected
        (patterns, n, m) gain P H' S^-1; (patterns, m, m) covariance S = H P H' + R of the
        innovation; (patterns, n, n) covariance after the measurement.

    Raises
    ------
    InputError
        If a measurement without noise repeats what is already known exactly.
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
    """x + K e for (series, n), (series, n, m) and (series, m); NaN in e counts as zero."""
    return x + multiply(K, np.nan_to_num(innovation))


def compute_nis(innovation: Array, innovation_covariance: Array) -> Array:
    """e' S^-1 e for (..., m) and (..., m, m); NaN in e counts as zero."""
    e = np.nan_to_num(innovation)
    return np.asarray(np.sum(e * np.linalg.solve(innovation_covariance, e[..., None])[..., 0], -1))


def multiply(matrix: Array, vector: Array) -> Array:
    """(..., n, m) times (..., m)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


def transpose(matrix: Array) -> Array:
    """(..., n, m) to (..., m, n)."""
    return np.swapaxes(matrix, -1, -2)
