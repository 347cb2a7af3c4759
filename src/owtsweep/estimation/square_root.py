"""The Kalman filter by square roots of covariances.

Covariances are kept as roots: matrices L with L L' equal to the covariance. A step makes
the next root by an orthogonal transformation of what adds up to the next covariance (Anderson and
Moore 1979, section 6.5). Each row of a root keeps its own relative accuracy, so inputs of 1e6 N may
stand beside displacements of 1e-3 m, and a prior variance of 1e6 beside a sensor's of 1e-12,
without any scaling.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: Standard deviations beyond this count as overflow: a filter is unstable.
OVERFLOW = 1e100


class Correction(NamedTuple):
    """The time update and the measurement update of a step of a Kalman filter.

    K: gain, shape (N, m).
    innovation: root of the innovation's covariance, shape (m, m), lower triangular.
    corrections: K times this root, shape (N, m).
    predicted, filtered: roots of the states' covariance before and after the measurement, (N, N).
    """

    K: Array
    innovation: Array
    corrections: Array
    predicted: Array
    filtered: Array


def kalman(F: Array, H: Array, Q: Array, R: Array, P0: Array) -> Iterator[Correction]:
    """Yield the Kalman filter's gains and covariances, step by step, until they overflow.

    F, H: transition matrix (N, N) and measurement matrix (m, N).
    Q, R: covariances of the noise of process and measurement, shapes (N, N) and (m, m).
    P0: covariance of the state one step before the first measurement, shape (N, N).
    Raises InputError if R is singular.
    """
    root_Q, root_R, root = root_of(Q), check_noise(R), root_of(P0)
    m, N = H.shape
    while not overflows(root):
        root = combine(F @ root, root_Q)
        both = combine(np.vstack([root_R, np.zeros((N, m))]), np.vstack([H @ root, root]))
        innovation, corrections, filtered = both[:m, :m], both[m:, :m], both[m:, m:]
        K = np.linalg.solve(innovation.T, corrections.T).T
        yield Correction(K, innovation, corrections, root, filtered)
        root = filtered


def deviation(root: Array) -> Array:
    """Return the standard deviations of the covariance with this root, shape (N,)."""
    return np.asarray(np.linalg.norm(root, axis=1))


def overflows(root: Array) -> bool:
    """Return whether the covariance with this root is too large to go on."""
    return not bool(np.all(np.abs(root) < OVERFLOW))


def combine(*roots: Array) -> Array:
    """Return the lower triangular root of the sum of L L' over the roots L, shape (N, any)."""
    return np.asarray(np.linalg.qr(np.hstack(roots).T, mode="r")).T


def root_of(covariance: Array) -> Array:
    """Return a root (N, N) of a covariance, which may be singular."""
    size = np.sqrt(np.abs(np.diagonal(covariance)))
    size = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(covariance / size[:, None] / size)
    return np.asarray(size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def check_noise(R: Array) -> Array:
    """Return the lower triangular root of R, the covariance (m, m) of the sensors' noise.

    Raises InputError if R is singular: a sensor without noise.
    """
    try:
        return np.linalg.cholesky(R)
    except np.linalg.LinAlgError:
        raise InputError(
            "R: the covariance of the sensors' noise is singular; give every sensor some noise"
        ) from None
