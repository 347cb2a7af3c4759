"""Computes sums and means that depend, bit for bit, only on the terms and their order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array


def ordered_sum(samples: Array) -> Array:
    """Sum over the last axis, adding the terms strictly in their order.

    `np.sum` adds terms in groups that depend on the shape of the array. So the rounding error of
    `np.sum` depends on the shape, too.
    """
    if samples.ndim > 1 and samples.strides[-1] > min(samples.strides[:-1]):
        # The sums of all cells at once, in the same order of terms.
        total = samples[..., 0].copy(order="K")
        for place in range(1, samples.shape[-1]):
            total += samples[..., place]
        return total
    return np.asarray(np.cumsum(samples, axis=-1)[..., -1])


def mean_and_error(samples: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """Compute means over the last axis, ignoring NaN; return (means, standard errors, counts).

    The counts are the numbers of samples that are finite. The mean of no sample is NaN, and so is
    the standard error of fewer than two samples.
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
