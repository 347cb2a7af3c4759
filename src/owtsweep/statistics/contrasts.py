"""Differences and ratios of two runs' means: paired by replicate, or unpaired by Welch's method.

Source: Welch (1947), The generalization of 'Student's' problem. The interval of a ratio mean(b) /
mean(a) comes from the delta method for its logarithm: replicate r influences the logarithm by b_r /
mean(b) - a_r / mean(a).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.statistics.inference import mean_and_error, p_value, t_quantile

#: Numbers of replicates.
Counts = NDArray[np.intp]


class Contrast(NamedTuple):
    """An estimated difference or ratio with its uncertainty.

    `value`, `low`, `high`: the estimate and the ends of its 95 % confidence interval; the ends are
    NaN where there is too little data. `p`: two-sided p-value; 1 where there is too little data.
    """

    value: Array
    low: Array
    high: Array
    p: Array


def gap(samples: Array) -> Contrast:
    """Compare the mean over the last axis with zero, ignoring NaN, by the t-test.

    `value` is the mean, in the shape of `samples` without that axis.
    """
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        mean, error, n = mean_and_error(samples)
    return _student(mean, error, n - 1.0)


def difference(first: Array, second: Array, *, paired: bool) -> Contrast:
    """Compute the difference of means over the replicates, the last axis: `second` minus `first`.

    If `paired`, only replicates that finished (are not NaN) in both samples are used.
    """
    if paired:
        return gap(second - first)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        (a, error_a, n_a), (b, error_b, n_b) = mean_and_error(first), mean_and_error(second)
        return _welch(b - a, error_a, n_a, error_b, n_b)


def ratio(first: Array, second: Array, *, paired: bool) -> Contrast:
    """Compute the ratio of means over the replicates, the last axis: `second` divided by `first`.

    If a mean is not positive, the ratio has no interval; 0 / 0 is NaN. If `paired`, only replicates
    that finished (are not NaN) in both samples are used.
    """
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        if paired:
            both = np.isfinite(first) & np.isfinite(second)
            first, second = np.where(both, first, np.nan), np.where(both, second, np.nan)
        (a, error_a, n_a), (b, error_b, n_b) = mean_and_error(first), mean_and_error(second)
        if paired:
            influence = second / b[..., None] - first / a[..., None]
            _, error, n = mean_and_error(influence)
            logs = _student(np.log(b / a), error, n - 1.0)
        else:
            logs = _welch(np.log(b / a), error_a / a, n_a, error_b / b, n_b)
        return logs._replace(value=b / a, low=np.exp(logs.low), high=np.exp(logs.high))


def _welch(value: Array, error_a: Array, n_a: Counts, error_b: Array, n_b: Counts) -> Contrast:
    """Compare the difference `value` of two means with zero, by Welch's t-test.

    The degrees of freedom follow Welch and Satterthwaite.
    """
    error = np.sqrt(error_a**2 + error_b**2)
    share_a, share_b = error_a**4 / (n_a - 1.0), error_b**4 / (n_b - 1.0)
    exact = (error == 0.0) & (n_a > 1) & (n_b > 1)
    freedom = np.where(exact, n_a + n_b - 2.0, error**4 / (share_a + share_b))
    return _student(value, error, freedom)


def _student(value: Array, error: Array, freedom: Array) -> Contrast:
    testable = np.isfinite(value) & np.isfinite(error) & (freedom > 0)
    margin = np.where(testable, t_quantile(freedom) * error, np.nan)
    return Contrast(value, value - margin, value + margin, p_value(value, error, freedom))
