"""The confidence interval of a ratio of two means.

Source: Fieller (1954), Some problems in interval estimation.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array


def fieller(a: Array, b: Array, quantile: float) -> tuple[float, float]:
    """Compute the confidence interval of mean(a) / mean(b) by Fieller's theorem.

    The interval holds the ratios r for which the paired t-test does not reject that mean(a) equals
    r mean(b).

    Parameters
    ----------
    a, b
        Paired samples, not negative, shape (n,).
    quantile
        Quantile of Student's t with n - 1 degrees of freedom, e.g. the 97.5 % quantile for an
        interval of 95 %.

    Returns
    -------
    tuple of float
        The lower end, at least 0, and the upper end; both are NaN if `b` scatters so much that the
        interval has no end.
    """
    n = len(a)
    A, B = np.mean(a), np.mean(b)
    with np.errstate(over="ignore", invalid="ignore"):  # the square of a square may be too large
        variance = np.cov(a, b) * quantile**2 / n
        square = B * B - variance[1, 1]
        if square <= 0.0:
            return float("nan"), float("nan")
        half = A * B - variance[0, 1]
        root = np.sqrt(max(half * half - square * (A * A - variance[0, 0]), 0.0))
        return max(float((half - root) / square), 0.0), float((half + root) / square)
