"""The smoother of fixed lag of a linear filter whose gains settle.

An estimate of step k from the measurements up to step k + L is the prediction plus a correction
(Bryson and Frazier 1963; Anderson and Moore 1979, section 7.3): with the innovations e, their
covariances S and the closed loop of predictions Psi[k] = F (I - K[k] H),

    x[k|k+L] = x[k|k-1] + P[k|k-1] z[k],   z[k] = H' S[k]^-1 e[k] + Psi[k]' z[k+1],   z[k+L+1] = 0.

No covariance is inverted. So a direction that no sensor sees, whose variance grows for ever, does
no harm: z has no part in it. Once the gains have settled, the correction is a weighted sum of L + 1
innovations, with weights that stay.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.input_state import Filter, Step, settle, to_step
from owtsweep.estimation.square_root import Correction, kalman

#: Steps that are smoothed at once, so that little memory is needed.
CHUNK = 4096


@dataclass(frozen=True, kw_only=True)
class Lagged(Filter):
    """A Kalman filter with a smoother of fixed lag; its gains are those of `rows` early steps.

    transition, measuring: transition matrix F (N, N) and measurement matrix H (m, N).
    predicted: covariances of the predicted state in the early steps, shape (rows, N, N).
    weights: H' S^-1 in the early steps, shape (rows, N, m).
    lag: in steps.
    """

    transition: Array
    measuring: Array
    predicted: Array
    weights: Array
    lag: int

    def run(self, y: Array) -> Array:
        """Return estimates (steps, N) from measurements y (steps, m) up to `lag` steps after each.

        Raises InputError if y has another shape, or holds a value that is not finite.
        """
        x = self.run_states(y)
        predicted = np.zeros_like(x)
        predicted[1:] = x[:-1] @ self.transition.T
        innovations = y - predicted @ self.measuring.T
        # After the record's end nothing is measured: innovations of zero correct nothing.
        innovations = np.vstack([innovations, np.zeros((self.lag, y.shape[1]))])
        early = min(len(self.predicted) - 1, len(y))
        predicted[:early] += self._correct_early(innovations, early)
        predicted[early:] += self._correct_settled(innovations[early:])
        return predicted

    def _correct_early(self, innovations: Array, early: int) -> Array:
        """Return the corrections of the first `early` steps, shape (early, N)."""
        loops = self.transition - self.transition @ self.early_K @ self.measuring
        at = np.arange(early)
        z = np.zeros((early, len(self.transition), 1))
        for ahead in range(self.lag, -1, -1):
            row = np.minimum(at + ahead, len(loops) - 1)
            z = np.swapaxes(loops, 1, 2)[row] @ z
            z += self.weights[row] @ innovations[at + ahead, :, None]
        return np.asarray((self.predicted[:early] @ z)[:, :, 0])

    def _correct_settled(self, innovations: Array) -> Array:
        """Return corrections (steps, N) with settled weights; `innovations` go `lag` rows on."""
        loop = (self.transition - self.transition @ self.K @ self.measuring).T
        weight, weights = self.weights[-1], []
        for _ in range(self.lag + 1):
            weights.append(self.predicted[-1] @ weight)
            weight = loop @ weight
        N = len(loop)
        stacked = np.stack(weights, axis=2).reshape(N, -1)  # per measurement, then per step ahead
        if len(innovations) <= self.lag:
            return np.zeros((0, N))
        windows = np.lib.stride_tricks.sliding_window_view(innovations, self.lag + 1, axis=0)
        result = np.empty((len(windows), N))
        for start in range(0, len(windows), CHUNK):
            chunk = windows[start : start + CHUNK]
            result[start : start + CHUNK] = chunk.reshape(len(chunk), -1) @ stacked.T
        return result


def make_smoother(F: Array, H: Array, Q: Array, R: Array, P0: Array, lag: int) -> Lagged:
    """Make the fixed-lag smoother of x[k+1] = F x[k] + w[k], y[k] = H x[k] + v[k].

    Parameters are those of `square_root.kalman`; `lag` is in steps.

    Raises InputError if the lag is negative, a matrix is no covariance, or R is singular.
    """
    if lag < 0:
        raise InputError(f"lag: {lag} steps; give 0 or more")
    made: list[Correction] = []

    def steps() -> Iterator[Step]:
        for correction in kalman(F, H, Q, R, P0):
            made.append(correction)
            yield to_step(F, H, correction)

    filter = settle(steps())
    return Lagged(
        **vars(filter),
        transition=F,
        measuring=H,
        predicted=np.array([step.predicted @ step.predicted.T for step in made]),
        weights=np.array([_weigh(H, step.innovation) for step in made]),
        lag=lag,
    )


def _weigh(H: Array, innovation: Array) -> Array:
    """Return H' S^-1 (N, m), for the root (m, m) of S."""
    return np.asarray(np.linalg.solve(innovation @ innovation.T, H).T)
