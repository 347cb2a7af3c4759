"""Means, intervals and tests: Student's t, Holm's correction, Fieller's ratio, the bootstrap.

Sums and means depend, bit for bit, only on the terms and their order. Sources: Student (1908), The
probable error of a mean. Holm (1979), A simple sequentially rejective multiple test procedure.
Fieller (1954), Some problems in interval estimation. Efron and Tibshirani (1993), An introduction
to the bootstrap, chapters 10 and 13.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from owtsweep.arrays import Array

#: Confidence level: intervals cover 95 %, tests reject at 5 %.
CONFIDENCE = 0.95
RESAMPLES = 4000
#: Seed of the draws: the same records always give the same draws.
SEED = 20190601


def ordered_sum(samples: Array) -> Array:
    """Sum over the last axis, adding the terms strictly in their order.

    `np.sum` adds in groups that depend on the shape of the array, and so does its rounding error.
    """
    if samples.ndim > 1 and samples.strides[-1] > min(samples.strides[:-1]):
        # The sums of all cells at once, in the same order of terms.
        total = samples[..., 0].copy(order="K")
        for place in range(1, samples.shape[-1]):
            total += samples[..., place]
        return total
    return np.asarray(np.cumsum(samples, axis=-1)[..., -1])


def mean_and_error(samples: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """Return means over the last axis, ignoring NaN, their standard errors, and numbers of terms.

    The mean of no sample is NaN, and so is the standard error of fewer than two samples.
    """
    present = np.isfinite(samples)
    n = present.sum(axis=-1)
    whole = bool(present.all())
    mean = ordered_sum(samples if whole else np.where(present, samples, 0.0)) / n
    deviation = samples - mean[..., np.newaxis]
    if not whole:
        deviation = np.where(present, deviation, 0.0)
    with np.errstate(over="ignore"):  # a scheme that diverges has no finite interval
        spread = ordered_sum(np.square(deviation, out=deviation))
    error = np.sqrt(spread / np.where(n > 1, n * (n - 1.0), np.nan))
    return mean, error, n


def t_quantile(freedom: ArrayLike) -> Array:
    """Return the half-width of a 95 % confidence interval, in standard errors of the estimate.

    `freedom` are degrees of freedom of Student's t; fewer than 1 count as 1.
    """
    from scipy.special import stdtrit

    # Quantiles are slow to compute, and a large table has few different counts.
    distinct, place = np.unique(np.maximum(freedom, 1), return_inverse=True)
    quantile = stdtrit(distinct, 0.5 + CONFIDENCE / 2.0)[place]
    return np.asarray(quantile.reshape(np.shape(freedom)))


def p_value(value: ArrayLike, error: ArrayLike, freedom: ArrayLike) -> Array:
    """Return the two-sided p-value of the t-test that a quantity is zero.

    If the standard error is 0, p is 1 for the value 0, and 0 for any other value. Where the degrees
    of freedom are not positive, or value or error is not finite, p is 1.
    """
    from scipy.special import stdtr

    tested = np.isfinite(value) & np.isfinite(error) & (np.asarray(freedom) > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        p = 2.0 * stdtr(np.where(tested, freedom, 1.0), np.divide(-np.abs(value), error))
    p = np.where(np.equal(error, 0.0), np.where(np.equal(value, 0.0), 1.0, 0.0), p)
    return np.where(tested, p, 1.0)


def holm(p_values: ArrayLike) -> NDArray[np.bool_]:
    """Return a mask (n,) of the hypotheses that Holm's test rejects, family-wise at 5 %."""
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    passed = p[order] <= (1.0 - CONFIDENCE) / (p.size - np.arange(p.size))
    rejected = np.zeros(p.size, dtype=bool)
    rejected[order] = np.logical_and.accumulate(passed)
    return rejected


def fieller(a: Array, b: Array, quantile: float) -> tuple[float, float]:
    """Compute the confidence interval of mean(a) / mean(b) by Fieller's theorem.

    It holds the ratios r for which the paired t-test does not reject that mean(a) equals r mean(b).
    `a` and `b` are paired samples, not negative, shape (n,); `quantile` is that of Student's t with
    n - 1 degrees of freedom, e.g. the 97.5 % quantile for an interval of 95 %. Return the lower
    end, at least 0, and the upper end; both are NaN if `b` scatters so much that the interval has
    no end.
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


def resample_means(records: Array, key: Sequence[int]) -> Array:
    """Draw resamples of records (records, quantities) with replacement; return the mean of each.

    The means have the shape (`RESAMPLES`, quantities), or (0, quantities) if there are fewer than
    two records. `key` holds integers that are not negative. Sets of records that are independent
    need different keys, which give different draws. Equal keys and equally many records give equal
    draws.
    """
    n = len(records)
    if n < 2:
        return np.empty((0, records.shape[1]))
    sequence = np.random.SeedSequence(SEED, spawn_key=(*key, n))
    draws = np.random.Generator(np.random.SFC64(sequence)).integers(0, n, size=(RESAMPLES, n))
    return np.asarray(records[draws].mean(axis=1))


def percentile_interval(samples: Array) -> Array:
    """Return the ends of the intervals that hold the central 95 % of the samples: lower, upper.

    `samples` has the shape (n, ...), the result (2, ...). A NaN sample counts as -infinity for the
    lower end and as infinity for the upper end. A lower end of -infinity is returned as NaN.
    """
    tail, none = 0.5 * (1.0 - CONFIDENCE), np.isnan(samples)
    low = np.quantile(np.where(none, -np.inf, samples), tail, axis=0, method="lower")
    high = np.quantile(np.where(none, np.inf, samples), 1.0 - tail, axis=0, method="higher")
    return np.stack([np.where(low > -np.inf, low, np.nan), high])
