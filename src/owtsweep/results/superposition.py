"""Computes results of a linear scheme at any amplitude from runs with only motion or only noise.

The error of a linear scheme at amplitude N is N times the error from motion of amplitude 1, plus
the error from noise. So its mean square is a parabola in N.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array

#: Mean squares of motion and noise and the mean of their product: the columns of a superposed row.
PRODUCTS = ("motion", "cross", "noise")


def superpose(motion: Any, cross: Any, noise: Any, amplitude: Any) -> Any:
    """The mean square error at an amplitude N: N^2 motion + 2 N cross + noise.

    Parameters
    ----------
    motion, cross, noise
        Numbers, arrays or columns, at amplitude 1: mean square of the error from motion, mean
        product of the errors from motion and noise, mean square of the error from noise.
    amplitude
        A number, or an array that can be broadcast against them.
    """
    return amplitude**2 * motion + 2.0 * amplitude * cross + noise


def find_crossing(products: Array) -> Array:
    """Find the amplitude at which a superposed difference turns from negative to positive.

    Parameters
    ----------
    products
        (n, 3) differences of `PRODUCTS`.

    Returns
    -------
    array
        (n,). 0 where it is positive throughout, infinite where it is negative throughout, NaN where
        it changes from positive to negative or changes twice.
    """
    a, c, f = np.asarray(products, dtype=float).T
    discriminant = c * c - a * f
    with np.errstate(divide="ignore", invalid="ignore"):
        # for c > 0 this form of (-c + sqrt(...)) / a avoids cancellation and allows a = 0
        root = np.where(
            c > 0.0,
            -f / (c + np.sqrt(discriminant)),
            (-c + np.sqrt(discriminant)) / a,
        )
    peak = np.where(a != 0.0, -c / np.where(a != 0.0, a, 1.0), np.inf)
    turns_inside = (peak > 0.0) & (discriminant > 0.0)
    result = np.full(len(a), np.nan)
    single = (f < 0.0) & ((a > 0.0) | ((a == 0.0) & (c > 0.0)))
    result[single] = root[single]
    result[(f >= 0.0) & (a >= 0.0) & ~turns_inside] = 0.0
    result[(f <= 0.0) & (a <= 0.0) & ~turns_inside] = np.inf
    return result
