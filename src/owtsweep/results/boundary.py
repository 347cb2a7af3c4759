"""The boundary of two schemes: where, along the condition that expands, they are equally good.

Per record MSE(N) = N^2 motion + 2 N cross + noise (`superposition`), so the mean difference of two
schemes is a parabola in the amplitude N, and the boundary is its root. So it does not depend on a
grid of amplitudes. Intervals are percentiles of a bootstrap over the records. Both schemes saw the
same records, so the three products of a record are drawn together.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.results.conditions import Condition, Value, show_value
from owtsweep.results.status import OK
from owtsweep.results.superposition import PRODUCTS, find_crossing
from owtsweep.statistics.bootstrap import percentile_interval, resample_means
from owtsweep.streams import encode_value

if TYPE_CHECKING:
    import pandas as pd

#: The columns of a table of boundaries, after those of the conditions.
COLUMNS = ("boundary", "ci_low", "ci_high", "n", "wins")
#: A cell: one value of every condition except the one that expands.
Cell = tuple[Value, ...]


def find_boundary(
    rows: pd.DataFrame,
    conditions: Sequence[Condition],
    schemes: tuple[str, str],
    measure: str,
    window: str,
) -> pd.DataFrame:
    """Find where the second scheme becomes better than the first, per cell of other conditions.

    Parameters
    ----------
    rows
        The rows of a run's cases; only superposed ones are used.
    conditions
        The study's; the last expands.
    schemes
        The one that is expected to win below the boundary, and the one above it.
    measure, window
        The measure and the window to compare.

    Returns
    -------
    DataFrame
        The other conditions and `COLUMNS`, sorted by condition. `boundary` (in the unit of the
        condition that expands) and its 95 % interval; `n`, the records that both schemes finished.
        Without a boundary it is NaN and `wins` names the scheme that is better at every amplitude;
        where the means cross the other way round, or twice, it is NaN and `wins` is "neither".
        Otherwise `wins` is empty. An end of an interval is 0 (infinite) if it falls on a resample
        in which the second (first) scheme is better throughout. The interval is NaN for one record,
        for means without a boundary, and where resamples cannot be ordered.

    Raises
    ------
    InputError
        If a scheme, the measure or the window is not among superposed rows.
    """
    import pandas as pd

    lines = []
    difference = subtract_schemes(rows, conditions, schemes, measure, window)
    for cell, products in split_cells(difference).items():
        value, low, high, wins = _find_mean_crossing(products), np.nan, np.nan, ""
        if not 0.0 < value < np.inf:
            wins = {0.0: schemes[1], np.inf: schemes[0]}.get(value, "neither")
            value = np.nan
        elif len(products) > 1:
            low, high = percentile_interval(_resample_crossings(cell, products))
        lines.append((*cell, value, low, high, len(products), wins))
    return pd.DataFrame(lines, columns=[*(c.name for c in conditions[:-1]), *COLUMNS])


def find_boundary_ratio(
    rows: pd.DataFrame,
    conditions: Sequence[Condition],
    cells: tuple[Cell, Cell],
    schemes: tuple[str, str],
    measure: str,
    window: str,
) -> tuple[float, float, float]:
    """The boundary in the first cell divided by that in the second, with its 95 % interval.

    The records of two cells are independent, so they are resampled independently. Other parameters
    are those of `find_boundary`.

    Returns
    -------
    tuple of float
        As `divide_crossings` returns it.

    Raises
    ------
    InputError
        As `find_boundary`, and if a cell is not among the rows.
    """
    by_cell = split_cells(subtract_schemes(rows, conditions, schemes, measure, window))
    products = []
    for cell in cells:
        near = [there for there in by_cell if _same(there, cell)]
        if not near:
            outer = conditions[:-1]
            present = ", ".join(" ".join(map(show_value, there)) for there in by_cell)
            shown = " ".join(c.show(value) for c, value in zip(outer, cell, strict=True))
            raise InputError(
                f"{' '.join(c.name for c in outer)}: no records at {shown}; the rows have "
                f"{present} {outer[-1].unit}".rstrip()
            )
        products.append((near[0], by_cell[near[0]]))
    return divide_crossings(*products)


def subtract_schemes(
    rows: pd.DataFrame,
    conditions: Sequence[Condition],
    schemes: tuple[str, str],
    measure: str,
    window: str,
) -> pd.DataFrame:
    """Products of the first scheme minus those of the second, of records that both finished.

    Parameters and errors are those of `find_boundary`. The columns are `PRODUCTS`; the index is the
    other conditions and the replicate, sorted.
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
    """Cell -> (records, 3), from what `subtract_schemes` returns."""
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
    """The boundary in one cell divided by that in another, with its 95 % interval.

    Parameters
    ----------
    above, below
        Each a cell and its (records, 3) differences of products. Equal cells draw the same records.
    apart
        Draw different records for the cell `above` even if the two cells are equal.

    Returns
    -------
    tuple of float
        Ratio and the ends of its interval; NaN where one of the two has no boundary. An end is 0 or
        infinite as in `find_boundary`. Resamples with 0 / 0 or inf / inf are NaN and count beyond
        both ends.
    """
    a, b = _find_mean_crossing(above[1]), _find_mean_crossing(below[1])
    if not (0.0 < a < np.inf and 0.0 < b < np.inf):
        return np.nan, np.nan, np.nan
    if min(len(above[1]), len(below[1])) < 2:
        return a / b, np.nan, np.nan
    samples = _resample_crossings(*above, apart=apart), _resample_crossings(*below)
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = percentile_interval(samples[0] / samples[1])
    return a / b, low, high


def _find_mean_crossing(products: Array) -> float:
    """The root of the mean of (records, 3) differences."""
    return float(find_crossing(products.mean(axis=0)[None])[0])


def _resample_crossings(cell: Cell, products: Array, *, apart: bool = False) -> Array:
    """Roots of the means of resampled records."""
    key = [encode_value(value) for value in cell] or [0]
    if apart:  # a different key draws different records: the first condition is shifted by 1e4
        key[0] += 10**10
    return find_crossing(resample_means(products, key))


def _same(one: Cell, other: Cell) -> bool:
    return all(
        a == b if isinstance(a, str) or isinstance(b, str) else np.isclose(a, b, rtol=1e-9)
        for a, b in zip(one, other, strict=True)
    )
