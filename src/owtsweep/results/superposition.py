"""Computes results of a linear scheme at any amplitude from runs with only motion or only noise.

The error of a linear scheme at amplitude N is N times the error due to motion of amplitude 1, plus
the error due to noise. The mean square of this error is therefore a parabola in N.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.results.conditions import Value

#: The columns of a superposed row: mean square of the error due to motion, mean product of the
#: errors due to motion and noise, mean square of the error due to noise.
PRODUCTS = ("motion", "cross", "noise")


def superpose(
    motion: Array | float, cross: Array | float, noise: Array | float, amplitude: Array | float
) -> Array:
    """Compute the mean square error at an amplitude N: N^2 motion + 2 N cross + noise.

    `motion` is the mean square of the error due to motion of amplitude 1, `noise` that of the error
    due to noise, and `cross` the mean product of these two errors.
    """
    return np.asarray(amplitude**2 * motion + 2.0 * amplitude * cross + noise)


def superpose_all(products: Array, amplitudes: Sequence[Value]) -> Array:
    """Compute the mean square errors at all amplitudes from the products of superposed rows.

    Products have the shape (3, measure, window, replicate), the result (amplitude, measure, window,
    replicate). The longer of the axes amplitude and replicate is innermost in memory, where loops
    and sums are fastest.
    """
    N = np.asarray(amplitudes)
    if len(N) <= products.shape[-1]:
        motion, cross, noise = products[:, np.newaxis]
        N = N[:, np.newaxis, np.newaxis, np.newaxis]
        return superpose(motion, cross, noise, N)
    motion, cross, noise = products.transpose(0, 3, 1, 2)[..., np.newaxis]
    return superpose(motion, cross, noise, N).transpose(3, 1, 2, 0)


def find_crossing(products: Array) -> Array:
    """Find the amplitude N > 0 at which the parabola N^2 a + 2 N c + f turns positive, shape (n,).

    `products` has a row (a, c, f) per parabola, shape (n, 3): differences between two schemes in
    motion, cross and noise. The amplitude is 0 for a parabola that is positive at every N > 0,
    infinite for one that is negative there, and NaN for one that changes from positive to negative
    or changes its sign twice.
    """
    a, c, f = np.asarray(products, dtype=float).T
    discriminant = c * c - a * f
    with np.errstate(divide="ignore", invalid="ignore"):
        # for c > 0 this form of (-c + sqrt(...)) / a avoids cancellation and allows a = 0
        root = np.where(c > 0.0, -f / (c + np.sqrt(discriminant)), (-c + np.sqrt(discriminant)) / a)
    peak = np.where(a != 0.0, -c / np.where(a != 0.0, a, 1.0), np.inf)
    turns_inside = (peak > 0.0) & (discriminant > 0.0)
    result = np.full(len(a), np.nan)
    single = (f < 0.0) & ((a > 0.0) | ((a == 0.0) & (c > 0.0)))
    result[single] = root[single]
    result[(f >= 0.0) & (a >= 0.0) & ~turns_inside] = 0.0
    result[(f <= 0.0) & (a <= 0.0) & ~turns_inside] = np.inf
    return result
