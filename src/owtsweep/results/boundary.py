"""Finds the boundary of two schemes: the amplitude at which they are equally good.

In each record the mean square error of a scheme at the amplitude N is N^2 motion + 2 N cross +
noise, with three products that do not depend on N (`superposition`). The mean difference between
two schemes is therefore a parabola in N, and the boundary is the parabola's root: it depends on no
grid of amplitudes. Confidence intervals are percentiles of a bootstrap, which resamples the
records. Both schemes saw the same records, so the products of both are drawn together.

In this module a cell is one value of each condition but the last, which is the amplitude.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.results.conditions import Condition, Value
from owtsweep.results.status import OK
from owtsweep.results.superposition import PRODUCTS, find_crossing
from owtsweep.statistics.inference import percentile_interval, resample_means
from owtsweep.streams import encode_value

#: The columns of a table of boundaries, after those of the conditions.
COLUMNS = ("boundary", "ci_low", "ci_high", "n", "wins")
#: A cell: one value of every condition except the one that expands.
Cell = tuple[Value, ...]


def find_boundary(difference: pd.DataFrame, schemes: tuple[str, str]) -> pd.DataFrame:
    """Find the amplitude above which the second scheme is better than the first, in each cell.

    `difference`: the table that `subtract_schemes` returns for the two `schemes`: first the scheme
    that is expected to be better below the boundary, then the one above.

    Returns: one row per cell, sorted by condition: all conditions but the last, then `COLUMNS`.
        `boundary` is in the unit of the amplitude. `n` is the number of records that both schemes
        finished. `wins` is "" if there is a boundary. Otherwise `boundary` is NaN, and `wins` names
        the scheme that is better at every amplitude. `wins` is "neither" if the second scheme is
        better only below some amplitude, or if the mean errors cross twice.
        `ci_low` and `ci_high` are the ends of the 95 % confidence interval of the boundary. They
        are NaN without a boundary, and with a single record. Otherwise they are percentiles of the
        boundaries of resampled records. The boundary of a resample counts as 0 if the second scheme
        is better at every amplitude, and as infinite if the first scheme is. A resample in which
        neither is true, and which has no boundary either, counts as lying below `ci_low` and above
        `ci_high`. If `ci_low` falls on such a resample, `ci_low` is NaN; if `ci_high` does,
        `ci_high` is infinite.
    """
    lines = []
    for cell, products in split_cells(difference).items():
        value, low, high, wins = _find_mean_crossing(products), np.nan, np.nan, ""
        if not 0.0 < value < np.inf:
            wins = {0.0: schemes[1], np.inf: schemes[0]}.get(value, "neither")
            value = np.nan
        elif len(products) > 1:
            low, high = percentile_interval(_resample_crossings(cell, products))
        lines.append((*cell, value, low, high, len(products), wins))
    return pd.DataFrame(lines, columns=[*difference.index.names[:-1], *COLUMNS])


def subtract_schemes(
    rows: pd.DataFrame,
    conditions: Sequence[Condition],
    schemes: tuple[str, str],
    measure: str,
    window: str,
) -> pd.DataFrame:
    """Subtract the second scheme's products from the first scheme's, in records that both finished.

    The result has the columns motion, cross and noise of superposed rows. It is indexed, and
    sorted, by all conditions but the last and by the replicate. Raise `InputError` if a scheme, the
    measure or the window is not among superposed rows.
    """
    *outer, last = [condition.name for condition in conditions]
    used = rows[(rows["status"] == OK) & rows[last].isna()]
    used = used[(used["measure"] == measure) & (used["window"] == window)]
    parts = []
    for argument, scheme in zip(("lower", "upper"), schemes, strict=True):
        part = used[used["scheme"] == scheme].set_index([*outer, "replicate"])
        if part.empty:
            raise InputError(
                f"{argument}: no superposed rows of scheme {scheme!r} with measure {measure!r} in "
                f"window {window!r}; a boundary needs evaluation=superposed and both schemes"
            )
        parts.append(part[list(PRODUCTS)].sort_index())
    common = parts[0].index.intersection(parts[1].index)
    return (parts[0].loc[common] - parts[1].loc[common]).sort_index()


def split_cells(difference: pd.DataFrame) -> dict[Cell, Array]:
    """Return cell -> (motion, cross, noise) of each record, shape (records, 3).

    `difference` is the table that `subtract_schemes` returns.
    """
    products = difference.to_numpy(dtype=float)
    outer = difference.index.names[:-1]
    cells: dict[Cell, list[int]] = {}
    for place, *cell in difference.reset_index()[outer].itertuples(name=None):
        cells.setdefault(tuple(cell), []).append(place)
    # column by column in memory: NumPy's means group their terms by the layout
    return {cell: np.asfortranarray(products[places]) for cell, places in cells.items()}


def divide_crossings(
    above: tuple[Cell, Array], below: tuple[Cell, Array], *, apart: bool = False
) -> tuple[float, float, float]:
    """Compute the ratio of the boundaries in two cells, with its confidence interval.

    Return the ratio and the ends of its 95 % confidence interval. All three are NaN if a cell has
    no boundary; the ends are NaN if a cell has a single record. Otherwise the ends are percentiles
    of the ratios in resampled records. In a resample the boundary counts as 0 if the second scheme
    is better at every amplitude, and as infinite if the first scheme is. A ratio that is undefined,
    such as 0 / 0, counts as lying below the lower end and above the upper end. If the lower end
    falls on an undefined ratio, the lower end is NaN; if the upper end does, the upper end is
    infinite.

    above, below: Numerator and denominator. Each is a cell, and the first scheme's products motion,
        cross and noise minus the second scheme's, shape (records, 3). If the two cells are equal,
        the same records are drawn for both, but not with `apart`.
    """
    a, b = _find_mean_crossing(above[1]), _find_mean_crossing(below[1])
    if not (0.0 < a < np.inf and 0.0 < b < np.inf):
        return np.nan, np.nan, np.nan
    if min(len(above[1]), len(below[1])) < 2:
        return a / b, np.nan, np.nan
    samples = _resample_crossings(*above, apart=apart), _resample_crossings(*below)
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = percentile_interval(samples[0] / samples[1])
    return a / b, float(low), float(high)


def _find_mean_crossing(products: Array) -> float:
    """Return `find_crossing` of the mean of the products, shape (records, 3)."""
    return float(find_crossing(products.mean(axis=0)[None])[0])


def _resample_crossings(cell: Cell, products: Array, *, apart: bool = False) -> Array:
    """Draw resamples of a cell's records; return the boundary of each, as `find_crossing` does.

    The draws depend only on `cell`, on the number of records, and on `apart`, which draws others.
    """
    key = [encode_value(value) for value in cell] or [0]
    if apart:  # a different key draws different records: the first condition is shifted by 1e4
        key[0] += 10**10
    return find_crossing(resample_means(products, key))
