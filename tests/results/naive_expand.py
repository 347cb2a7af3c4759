"""One value per case: superposed rows at every value of the condition that expands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.status import OK
from owtsweep.results.superposition import PRODUCTS, superpose
from owtsweep.results.unable import without_unable

if TYPE_CHECKING:
    import pandas as pd


def expand(rows: pd.DataFrame, conditions: Sequence[Condition], grid: Grid) -> pd.DataFrame:
    """One value per scheme, cell, measure, window and replicate.

    Parameters
    ----------
    rows
        The rows of a run's cases. If the last condition expands, a row without a value of it is
        superposed and stands for all values (`superposition.superpose`); any other row holds a
        single `value`.
    conditions, grid
        The study's conditions and their values; direct rows at other values of the condition that
        expands are left out.

    Returns
    -------
    DataFrame
        scheme, conditions, measure, window, replicate, value, in no particular order. Failed cases,
        schemes in cells that they are unable to work in, and values that are not finite (a scheme
        without covariance has no NEES) are absent.
    """
    import pandas as pd

    names = [condition.name for condition in conditions]
    columns = ["scheme", *names, "measure", "window", "replicate", "value"]
    rows = without_unable(rows, conditions)
    values = rows[rows["status"] == OK]
    if conditions[-1].expands:
        last = names[-1]
        is_superposed = values[last].isna()
        direct = values[~is_superposed & values[last].isin(list(grid[last]))]
        superposed = values[is_superposed]
        factors = np.unique(np.asarray(grid[last], dtype=float))
        motion, cross, noise = (
            superposed[name].to_numpy(dtype=float)[:, np.newaxis] for name in PRODUCTS
        )
        repeated = superposed.iloc[np.repeat(np.arange(len(superposed)), len(factors))]
        expanded = repeated.assign(
            **{last: np.tile(factors, len(superposed))},
            value=superpose(motion, cross, noise, factors).ravel(),
        )
        # with an empty part, concat would warn and take its dtypes from that part
        parts = [part for part in (expanded, direct) if len(part)] or [expanded]
        values = pd.concat(parts, ignore_index=True)
    finite = np.isfinite(values["value"].to_numpy(dtype=float))
    table: pd.DataFrame = values.loc[finite, columns]
    return table.reset_index(drop=True)
