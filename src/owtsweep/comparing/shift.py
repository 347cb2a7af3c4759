"""How far the boundary of two schemes lies from where it lay in another run."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.results import boundary as roots
from owtsweep.results.boundary import RESAMPLES
from owtsweep.sweep.study import OK

if TYPE_CHECKING:
    import pandas as pd

KEYS = ["natural_period", "replicate"]
COLUMNS = ("natural_period", "ratio", "ratio_low", "ratio_high")


def boundary_shift(
    first: pd.DataFrame,
    second: pd.DataFrame,
    schemes: tuple[str, str],
    measure: str,
    windows: tuple[str, str],
    *,
    paired: bool,
    resamples: int = RESAMPLES,
) -> list[dict[str, Any]]:
    """The boundary in the second run over that in the first, per natural period.

    The interval is the percentiles of a bootstrap over the records: one draw serves both runs if
    they are paired, each run is drawn by itself otherwise.

    Parameters
    ----------
    first, second
        Rows of two runs' cases.
    schemes
        The one that wins below the boundary and the one above it.
    measure, windows
        What is judged; the window of each run.

    Returns
    -------
    list of dict
        natural_period (s), ratio, ratio_low, ratio_high; only periods with a boundary in both.

    Raises
    ------
    InputError
        As `boundary`.
    """
    if paired:
        first, second = _common_records(first, second, schemes)
    one, two = (
        roots._differences(rows, *schemes, measure, window)
        for rows, window in zip((first, second), windows, strict=True)
    )
    found = []
    for period in sorted(set(one) & set(two)):
        a, b = (roots._root(d[period].mean(axis=0)[None])[0] for d in (one, two))
        if not (0.0 < a < np.inf and 0.0 < b < np.inf):
            continue
        low = high = np.nan
        # The period only seeds the draws: another one makes the second run's independent.
        other = period if paired else period + 1e4
        drawn_a = roots._resampled_roots(one[period], period, resamples)
        drawn_b = roots._resampled_roots(two[period], other, resamples)
        if len(drawn_a) and len(drawn_b):
            with np.errstate(divide="ignore", invalid="ignore"):
                low, high = roots._interval(drawn_b / drawn_a)
        found.append(
            {"natural_period": period, "ratio": float(b / a), "ratio_low": low, "ratio_high": high}
        )
    return found


def _common_records(
    first: pd.DataFrame, second: pd.DataFrame, schemes: tuple[str, str]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The rows of those records that both schemes finished in both runs."""
    done = [
        rows[(rows["scheme"] == scheme) & (rows["status"] == OK)].set_index(KEYS).index.unique()
        for rows in (first, second)
        for scheme in schemes
    ]
    common = reduce(lambda one, other: one.intersection(other), done)
    kept = [rows[rows.set_index(KEYS).index.isin(common)] for rows in (first, second)]
    return kept[0], kept[1]
