"""Student's t: quantiles for confidence intervals, and the t-test.

Source: Student (1908), The probable error of a mean.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array

#: Confidence level: intervals cover 95 %, tests reject at 5 %.
CONFIDENCE = 0.95


def t_quantile(freedom: Any) -> Array:
    """Return the half-width of a 95 % confidence interval, in standard errors of the estimate.

    Parameters
    ----------
    freedom
        Degrees of freedom of Student's t, any shape; fewer than 1 count as 1.
    """
    from scipy.special import stdtrit

    # Quantiles are slow to compute, and a large table has few different counts.
    distinct, place = np.unique(np.maximum(freedom, 1), return_inverse=True)
    quantile = stdtrit(distinct, 0.5 + CONFIDENCE / 2.0)[place]
    return np.asarray(quantile.reshape(np.shape(freedom)))


def p_value(value: Any, error: Any, freedom: Any) -> Array:
    """Return the two-sided p-value of the t-test that a quantity is zero.

    Parameters
    ----------
    value, error
        The estimate of the quantity, and its standard error. If the error is 0, p is 1 for the
        value 0, and 0 for any other value.
    freedom
        Degrees of freedom. Where they are not positive, or value or error is not finite, p is 1.
    """
    from scipy.special import stdtr

    tested = np.isfinite(value) & np.isfinite(error) & (np.asarray(freedom) > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        p = 2.0 * stdtr(np.where(tested, freedom, 1.0), -np.abs(value) / error)
    p = np.where(np.equal(error, 0.0), np.where(np.equal(value, 0.0), 1.0, 0.0), p)
    return np.where(tested, p, 1.0)
