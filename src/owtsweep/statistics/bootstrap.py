"""Bootstrap intervals: from records resampled with replacement.

Source: Efron and Tibshirani (1993), An introduction to the bootstrap, chapters 10 and 13.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.student import CONFIDENCE

RESAMPLES = 4000
#: Seed of the draws: the same records always give the same draws.
SEED = 20190601


def resample_means(records: Array, key: Sequence[int]) -> Array:
    """(`RESAMPLES`, quantities): means over records resampled with replacement.

    Parameters
    ----------
    records
        (records, quantities). With fewer than two records there is no resample.
    key
        Not negative. Different keys give different draws, for independent sets of records.
    """
    n = len(records)
    if n < 2:
        return np.empty((0, records.shape[1]))
    sequence = np.random.SeedSequence(SEED, spawn_key=(*key, n))
    draws = np.random.Generator(np.random.SFC64(sequence)).integers(0, n, size=(RESAMPLES, n))
    return np.asarray(records[draws].mean(axis=1))


def percentile_interval(samples: Array) -> tuple[float, float]:
    """The central 95 % of the samples.

    A NaN sample counts below the lower end and above the upper end. An end that falls on such a
    sample is NaN.
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    worst_low = np.sort(np.where(np.isnan(samples), -np.inf, samples))
    worst_high = np.sort(np.where(np.isnan(samples), np.inf, samples))
    low = worst_low[int(np.floor(tail * (len(samples) - 1)))]
    high = worst_high[int(np.ceil((1.0 - tail) * (len(samples) - 1)))]
    return float(low if low > -np.inf else np.nan), float(high)
