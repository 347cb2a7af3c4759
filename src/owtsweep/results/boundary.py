"""The amplitude at which two schemes are equally good, over natural period, with its interval.

Per record MSE(N) = N^2 motion + 2 N cross + noise, so the mean difference of two schemes is a
parabola in the amplitude N, and the boundary is its root: no grid of amplitudes enters. Intervals
are percentiles of a bootstrap over the records (both schemes saw the same ones, so a record is
drawn with both of its differences and its noise): Efron and Tibshirani (1993), chapters 13 and 10.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.sweep.study import OK

if TYPE_CHECKING:
    import pandas as pd

PRODUCTS = ("motion", "cross", "noise")
COLUMNS = ("natural_period", "boundary", "ci_low", "ci_high", "n", "wins")
RESAMPLES = 4000
CONFIDENCE = 0.95
#: Draws of records are the same whenever the same records are compared.
SEED = 20190601


def boundary(
    rows: pd.DataFrame,
    lower: str = "HME2",
    upper: str = "HME1",
    measure: str = "position",
    window: str = "full",
    *,
    resamples: int = RESAMPLES,
) -> pd.DataFrame:
    """Where `upper` becomes better than `lower` as the amplitude grows, per natural period.

    Parameters
    ----------
    rows
        The rows of a run's cases; superposed ones are used.
    lower, upper
        The scheme that is expected to win below the boundary, and above it.
    measure, window
        What is compared: "position" (x + y) or another MSE; "full" or "settled".
    resamples
        Bootstrap samples per natural period.

    Returns
    -------
    DataFrame
        `COLUMNS`, by natural period (s). `boundary` (m) and its 95 % interval; `n`, the records
        that both schemes finished. Without a boundary it is NaN and `wins` names the scheme that
        is better at every amplitude; where the means cross the other way round, or twice, it is
        NaN and `wins` is "neither". Otherwise `wins` is empty. An end of an interval is 0 or
        infinite where a resampled mean has `upper` or `lower` better throughout; the interval is
        NaN for one record, for means without a boundary, and for resamples without order.

    Raises
    ------
    InputError
        If a scheme, the measure or the window is not among superposed rows.
    """
    import pandas as pd

    found = []
    for period, differences in _differences(rows, lower, upper, measure, window).items():
        value, wins = _root(differences.mean(axis=0)[None])[0], ""
        if not 0.0 < value < np.inf:
            wins = {0.0: upper, np.inf: lower}.get(float(value), "neither")
        low, high = np.nan, np.nan
        if not wins and len(differences) > 1:
            low, high = _interval(_resampled_roots(differences, period, resamples))
        found.append((period, value if not wins else np.nan, low, high, len(differences), wins))
    return pd.DataFrame(found, columns=list(COLUMNS))


def boundary_ratio(
    rows: pd.DataFrame,
    period_a: float,
    period_b: float,
    *,
    lower: str = "HME2",
    upper: str = "HME1",
    measure: str = "position",
    window: str = "full",
    resamples: int = RESAMPLES,
) -> tuple[float, float, float]:
    """The boundary at period_a over that at period_b (s) with its 95 % interval.

    The records of two natural periods are independent, so they are resampled independently.

    Returns
    -------
    tuple of float
        Ratio and the ends of its interval; NaN where one of the two has no boundary. An end is 0
        or infinite as in `boundary`; resamples with 0 / 0 or inf / inf count against both ends.

    Raises
    ------
    InputError
        As `boundary`, and if a period is not among the rows.
    """
    differences = _differences(rows, lower, upper, measure, window)
    roots, samples = [], []
    for argument, period in (("period_a", period_a), ("period_b", period_b)):
        near = [known for known in differences if np.isclose(known, period, rtol=1e-9)]
        if not near:
            known = ", ".join(f"{value:g}" for value in differences)
            raise InputError(f"{argument}: no records at {period:g} s; the rows have {known} s")
        chosen = differences[near[0]]
        roots.append(_root(chosen.mean(axis=0)[None])[0])
        samples.append(_resampled_roots(chosen, near[0], resamples))
    a, b = roots
    if not (0.0 < a < np.inf and 0.0 < b < np.inf):
        return np.nan, np.nan, np.nan
    if any(len(sample) == 0 for sample in samples):
        return float(a / b), np.nan, np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = _interval(samples[0] / samples[1])
    return float(a / b), low, high


def _differences(
    rows: pd.DataFrame, lower: str, upper: str, measure: str, window: str
) -> dict[float, Array]:
    """Natural period -> (records, 3): products of `lower` less those of `upper`."""
    used = rows[(rows["status"] == OK) & rows["amplitude"].isna()]
    used = used[(used["measure"] == measure) & (used["window"] == window)]
    keys = ["natural_period", "replicate"]
    parts = []
    for argument, scheme in (("lower", lower), ("upper", upper)):
        part = used[used["scheme"] == scheme].set_index(keys)[list(PRODUCTS)].sort_index()
        if part.empty:
            raise InputError(
                f"{argument}: no superposed rows of scheme {scheme!r} with measure {measure!r} in "
                f"window {window!r}; a boundary needs evaluation=superposed and both schemes"
            )
        parts.append(part)
    common = parts[0].index.intersection(parts[1].index)
    difference = (parts[0].loc[common] - parts[1].loc[common]).sort_index()
    periods = common.get_level_values("natural_period").to_numpy(dtype=float)
    return {
        float(period): difference.xs(period, level="natural_period").to_numpy(dtype=float)
        for period in np.unique(periods)
    }


def _root(products: Array) -> Array:
    """The amplitude at which a N^2 + 2 c N + f turns from negative to positive, for (n, 3) rows.

    0 where it is positive throughout, infinite where it is negative throughout, NaN where it turns
    the other way or twice.
    """
    a, c, f = np.asarray(products, dtype=float).T
    discriminant = c * c - a * f
    with np.errstate(divide="ignore", invalid="ignore"):
        # for c > 0 this form of (-c + sqrt(...)) / a cancels nothing and allows a = 0
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


def _resampled_roots(differences: Array, period: float, resamples: int) -> Array:
    """Roots of the means of resampled records; none for a single record."""
    n = len(differences)
    if n < 2:
        return np.empty(0)
    draws = np.random.Generator(
        np.random.SFC64(np.random.SeedSequence(SEED, spawn_key=(round(period * 1e6), n)))
    ).integers(0, n, size=(resamples, n))
    return _root(_means(differences, draws))


def _means(differences: Array, draws: NDArray[np.int64]) -> Array:
    return np.asarray(differences[draws].mean(axis=1))


def _interval(samples: Array) -> tuple[float, float]:
    """Percentiles; a sample without order counts below the one end and above the other."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    worst_low = np.sort(np.where(np.isnan(samples), -np.inf, samples))
    worst_high = np.sort(np.where(np.isnan(samples), np.inf, samples))
    low = worst_low[int(np.floor(tail * (len(samples) - 1)))]
    high = worst_high[int(np.ceil((1.0 - tail) * (len(samples) - 1)))]
    return float(low if low > -np.inf else np.nan), float(high)
