"""Third differences of positions: what is left of the IMU's and the fixes' noise, and its size.

The difference between a measured position and the double integral of the measured acceleration
holds no motion. It is an unknown parabola (position and velocity at the start, constant bias), the
double integral of the IMU's white noise, the triple integral of the bias walk's noise, and the
noise of the measured position. Third divided differences remove every parabola. What is left has a
covariance with three bands beside its diagonal, so the exact likelihood takes microseconds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Points that a third difference needs.
POINTS = 4
#: Positions in a piece; longer series are cut, because the covariance becomes nearly singular.
LONGEST = 600


class Differences(NamedTuple):
    """Third differences of a series of positions at given times.

    Attributes
    ----------
    first
        Index of the first of the four positions of each difference, shape (n,).
    weights
        Weights of the four positions, shape (n, 4).
    of_position, of_white, of_walk
        Covariance of the differences, per axis, for unit noise: for positions with white noise of
        1 m; for a white acceleration noise of density 1 (m/s^2)^2/Hz; for an acceleration bias that
        walks with density 1 (m/s^2)^2/s. Shape (4, n) each: row k holds the covariances of
        difference j with difference j + k.
    """

    first: NDArray[np.int64]
    weights: Array
    of_position: Array
    of_white: Array
    of_walk: Array

    def apply(self, positions: Array) -> Array:
        """Return the third differences of a series, shape (n, 2), of positions (m, 2)."""
        return np.asarray(
            sum(self.weights[:, [k]] * positions[self.first + k] for k in range(POINTS))
        )


def take_differences(time: Array) -> Differences:
    """Make the third differences of positions at increasing times in s, shape (m,), m >= 4."""
    at = np.lib.stride_tricks.sliding_window_view(time, POINTS)
    apart = at[:, :, None] - at[:, None, :]
    apart[:, range(POINTS), range(POINTS)] = 1.0
    # for equal intervals the weights are -1, 3, -3, 1
    weights = 6.0 * np.median(np.diff(time)) ** 3 / np.prod(apart, axis=2)
    # what the noise of the interval after point i adds to each difference
    carried = np.zeros((len(at), POINTS - 1, 3))
    for i in range(POINTS - 1):
        for k in range(i + 1, POINTS):
            late = at[:, k] - at[:, i + 1]
            row = np.stack([np.ones_like(late), late, 0.5 * late**2], axis=1)
            carried[:, i] += weights[:, [k]] * row
    white, walk = _noise_of_intervals(np.diff(time))
    bands = np.zeros((3, POINTS, len(at)))
    for lag in range(min(POINTS, len(at))):
        here, there = slice(0, len(at) - lag), slice(lag, len(at))
        for k in range(lag, POINTS):
            bands[0, lag, here] += weights[here, k] * weights[there, k - lag]
        for i in range(lag, POINTS - 1):
            left, right = carried[here, i], carried[there, i - lag]
            inside = slice(i, i + len(at) - lag)
            for part, noise in ((1, white), (2, walk)):
                bands[part, lag, here] += np.einsum("ja,jab,jb->j", left, noise[inside], right)
    # without three differences in a row, what comes before and what comes after is independent
    at_all = np.arange(len(at), dtype=np.int64)
    kept = at_all[at_all % LONGEST < LONGEST - (POINTS - 1)]
    cut = bands[:, :, kept]
    for lag in range(1, POINTS):
        far = np.ones(len(kept), dtype=bool)
        far[: len(kept) - lag] = kept[lag:] - kept[: len(kept) - lag] != lag
        cut[:, lag, far] = 0.0
    return Differences(kept, weights[kept], *cut)


def _noise_of_intervals(length: Array) -> tuple[Array, Array]:
    """Return the covariance of position, velocity and bias that each interval adds.

    Returns that of white acceleration noise and that of a bias walk, of unit density, shape
    (n, 3, 3) each. `length` are the intervals' lengths in s, shape (n,).
    """
    white, walk = np.zeros((2, len(length), 3, 3))
    white[:, 0, 0] = length**3 / 3.0
    white[:, 0, 1] = white[:, 1, 0] = length**2 / 2.0
    white[:, 1, 1] = length
    walk[:, 0, 0] = length**5 / 20.0
    walk[:, 0, 1] = walk[:, 1, 0] = length**4 / 8.0
    walk[:, 0, 2] = walk[:, 2, 0] = length**3 / 6.0
    walk[:, 1, 1] = length**3 / 3.0
    walk[:, 1, 2] = walk[:, 2, 1] = length**2 / 2.0
    walk[:, 2, 2] = length
    return white, walk
