"""Confidence intervals by the bootstrap: records are resampled with replacement.

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
    """Draw resamples of records with replacement; return the mean of each resample.

    Parameters
    ----------
    records
        One row per record, shape (records, quantities).
    key
        Integers that are not negative. Sets of records that are independent need different keys,
        which give different draws. Equal keys and equally many records give equal draws.

    Returns
    -------
    array
        The means, shape (`RESAMPLES`, quantities); (0, quantities) if there are fewer than two
        records.
    """
    n = len(records)
    if n < 2:
        return np.empty((0, records.shape[1]))
    sequence = np.random.SeedSequence(SEED, spawn_key=(*key, n))
    draws = np.random.Generator(np.random.SFC64(sequence)).integers(0, n, size=(RESAMPLES, n))
    return np.asarray(records[draws].mean(axis=1))


def percentile_interval(samples: Array) -> tuple[float, float]:
    """Return the ends of the interval that holds the central 95 % of the samples: lower, upper.

    A NaN sample counts as -infinity for the lower end and as infinity for the upper end. A lower
    end of -infinity is returned as NaN.
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    worst_low = np.sort(np.where(np.isnan(samples), -np.inf, samples))
    worst_high = np.sort(np.where(np.isnan(samples), np.inf, samples))
    low = worst_low[int(np.floor(tail * (len(samples) - 1)))]
    high = worst_high[int(np.ceil((1.0 - tail) * (len(samples) - 1)))]
    return float(low if low > -np.inf else np.nan), float(high)
