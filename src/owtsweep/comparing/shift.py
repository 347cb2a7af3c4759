"""How far the boundary of two schemes moves from one run to another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.results.boundary import divide_crossings, subtract_schemes
from owtsweep.results.conditions import Condition
from owtsweep.results.status import OK

if TYPE_CHECKING:
    import pandas as pd

#: The columns after the conditions.
COLUMNS = ("ratio", "ratio_low", "ratio_high")


def compare_boundaries(
    runs: tuple[pd.DataFrame, pd.DataFrame],
    conditions: Sequence[Condition],
    schemes: tuple[str, str],
    measure: str,
    windows: tuple[str, str],
    *,
    paired: bool,
) -> list[dict[str, Any]]:
    """The boundary in the second run divided by that in the first, per cell of other conditions.

    The interval consists of percentiles of a bootstrap over the records. Paired runs share their
    draws; otherwise each run has different draws.

    Parameters
    ----------
    runs
        Rows of two runs' cases.
    conditions
        The study's; the last expands.
    schemes
        The one that wins below the boundary and the one above it.
    measure, windows
        The measure that is judged, and the window of each run.

    Returns
    -------
    list of dict
        The other conditions and `COLUMNS`; only cells with a boundary in both runs.

    Raises
    ------
    InputError
        As `results.boundary.find_boundary`.
    """
    outer = [condition.name for condition in conditions[:-1]]
    if paired:
        runs = _common_records(runs, schemes, [*outer, "replicate"])
    one, two = (
        subtract_schemes(rows, conditions, schemes, measure, window)
        for rows, window in zip(runs, windows, strict=True)
    )
    lines = []
    for cell in one:
        if cell in two:
            ratio = divide_crossings((cell, two[cell]), (cell, one[cell]), apart=not paired)
            if not np.isnan(ratio[0]):
                lines.append(dict(zip([*outer, *COLUMNS], [*cell, *ratio], strict=True)))
    return lines


def _common_records(
    runs: tuple[pd.DataFrame, pd.DataFrame], schemes: tuple[str, str], keys: list[str]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The rows of those records that both schemes finished in both runs."""
    done = [
        rows[(rows["scheme"] == scheme) & (rows["status"] == OK)].set_index(keys).index.unique()
        for rows in runs
        for scheme in schemes
    ]
    common = reduce(lambda one, other: one.intersection(other), done)
    first, second = (rows[rows.set_index(keys).index.isin(common)] for rows in runs)
    return first, second
