"""Computes the steady covariance of a Kalman filter whose measurements repeat with a period.

What a predict step, an update or a whole period does to a covariance P is one map,

    P -> A P (I + G P)^-1 A' + H,

and one such map after another is again such a map (Redheffer's star product). So the map of n
periods follows from n by doubling, and the covariance that repeats is its H for many periods:
Anderson (1978), "Second-order convergent algorithms for the steady-state Riccati equation", Int. J.
Control 28(2); Lainiotis (1979) for composition.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

#: Most doublings, unless a caller gives another number: 2^40 periods.
DOUBLINGS = 40
#: The covariance is steady when a doubling changes its diagonal by less than this share; also a
#: default.
STEADY = 1e-10


@dataclass(frozen=True)
class CovarianceMap:
    """The map P -> A P (I + G P)^-1 A' + H of a covariance; A, G and H have the shape (n, n).

    A: transition of the state's error.
    G: information of the measurements about the first state, symmetric.
    H: covariance of the last state if the first state is known exactly, symmetric.
    """

    A: Array
    G: Array
    H: Array

    def apply(self, P: Array) -> Array:
        """Compute the covariance after the map from the covariance P before, shape (n, n)."""
        updated = np.linalg.solve(np.eye(len(P)) + P @ self.G, P)
        return _symmetric(self.A @ updated @ self.A.T + self.H)

    def then(self, later: CovarianceMap) -> CovarianceMap:
        """Return the map of this map and of a later one after it."""
        n = len(self.A)
        both = np.linalg.solve(np.eye(n) + self.H @ later.G, np.hstack([self.A, self.H]))
        through, known = both[:, :n], both[:, n:]
        return CovarianceMap(
            A=later.A @ through,
            G=_symmetric(self.G + self.A.T @ later.G @ through),
            H=_symmetric(later.H + later.A @ known @ later.A.T),
        )

    def repeat(self, times: int) -> CovarianceMap:
        """Return the map of this map applied `times` times, once or more."""
        doubled, whole = self, None
        while times:  # its binary digits, the lowest first
            if times & 1:
                whole = doubled if whole is None else whole.then(doubled)
            times >>= 1
            if times:
                doubled = doubled.then(doubled)
        assert whole is not None
        return whole


def make_prediction(A: Array, Q: Array) -> CovarianceMap:
    """Return the map of a step x -> A x + w, where w has the covariance Q; shape (n, n) each."""
    return CovarianceMap(A, np.zeros_like(Q), Q)


def make_update(row: Array, variance: float) -> CovarianceMap:
    """Return the map of a measurement `row` x + v, where v has `variance`; `row` has shape (n,)."""
    n = len(row)
    return CovarianceMap(np.eye(n), np.outer(row, row) / variance, np.zeros((n, n)))


def find_steady_covariance(
    period: CovarianceMap, steady: float = STEADY, doublings: int = DOUBLINGS
) -> Array:
    """Compute the covariance (n, n) that the map of a period returns unchanged.

    Raises InputError if the covariance grows without end: the measurements do not see all states.
    """
    before = np.diagonal(period.H)
    for _ in range(doublings):
        period = period.then(period)
        after = np.diagonal(period.H)
        if not np.all(np.isfinite(after)):
            break
        if np.all(np.abs(after - before) <= steady * np.abs(after)):
            return period.H
        before = after
    raise InputError(
        "the covariance of the Kalman filter has no steady state: the measurements do not see all "
        "states; give a state that they do not see no process noise"
    )


def _symmetric(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))
