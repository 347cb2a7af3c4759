"""Arranges rows over the cells of a map; finds what it names in each: a scheme, or a baseline."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.studies.hub.conditions import MEASURES, get_conditions, get_grid
from owtsweep.studies.hub.listed import INSTEAD, list_baselines, scheme_names

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.results.cube import Cube
    from owtsweep.studies.hub.config import HubConfig

#: Baseline -> what it is, in the note on a map.
ESTIMATES = {
    "NONE": "an estimate of zero",
    "HOLD": "the last fix",
    "DELTA": "a straight line through the last two fixes",
}

#: What a map says of a baseline that has the least error in some cells, but beats no scheme there.
UNDECIDED = (
    "has the least error in some cells, but the data do not tell it and the best scheme apart there"
)
#: Window -> what an answer that judges it says of the other one.
OTHER_WINDOW = {
    "full": "Judged: the full record, with its start. Over the settled part alone, as `vary` and "
    "`replay` judge (measures.window=settled), another may be best.",
    "settled": "Judged: the settled part of a record. Over the full record, as `sweep` judges by "
    "default (measures.window=full), another may be best.",
}


class Winners(NamedTuple):
    """What a map of best schemes shows.

    Attributes
    ----------
    table
        Rows of the table best_scheme, one per cell. Where a baseline has less error than every
        scheme, the baseline is in the place of the best scheme, and the best scheme in that of the
        runner-up; `distinguishable` then says whether the baseline beats that scheme.
    names
        The schemes, and those baselines that have the least error in some cell.
    notes
        A sentence on each baseline that beats every scheme in some cell, and one on each that has
        the least error in some cell where the data do not show that.
    """

    table: pd.DataFrame
    names: list[str]
    notes: list[str]


def find_winners(config: HubConfig, best: pd.DataFrame, criterion: str, window: str) -> Winners:
    """Find what a map shows in each cell: the best scheme, or a baseline that has less error.

    Parameters
    ----------
    config
        The run's configuration, of one tuning.
    best
        The run's table best_scheme.
    criterion
        The measure by which schemes are judged, e.g. "position".
    window
        The part of the records over which the criterion is averaged: "full" or "settled".
    """
    names = scheme_names(config)
    table = best[(best["criterion"] == criterion) & (best["window"] == window)].copy()
    if "baseline_wins" not in table:
        return Winners(table, names, [])
    leads = (table["mse_baseline"] < table["mse_best"]).to_numpy()
    led = table[leads]
    wins = led["baseline_wins"].to_numpy(dtype=bool)
    changed: dict[str, Any] = {
        "best": led["baseline"],
        "mse_best": led["mse_baseline"],
        "runner_up": led["best"],
        "mse_runner_up": led["mse_best"],
        "difference": led["mse_best"] - led["mse_baseline"],
        "ci_low": np.nan,
        "ci_high": np.nan,
        "distinguishable": wins,
    }
    for name, values in changed.items():
        table.loc[leads, name] = values
    winning, undecided, leading = (
        [name for name in list_baselines(config) if (cells["baseline"] == name).any()]
        for cells in (led[wins], led[~wins], led)
    )
    told = [f"{name}: {ESTIMATES[name]} {UNDECIDED}." for name in undecided]
    return Winners(table, names + leading, explain(winning) + told)


def explain(baselines: list[str]) -> list[str]:
    """Return a sentence on each baseline that beats every scheme somewhere on a map."""
    return [f"{name}: {ESTIMATES[name]} beats every scheme: {INSTEAD[name]}." for name in baselines]


def make_cube(config: HubConfig, rows: pd.DataFrame, *, baselines: bool = False) -> Cube:
    """Arrange a run's rows as arrays over schemes, conditions, measures and replicates (a cube).

    With `baselines` the cube holds the run's baselines too, after the schemes.
    """
    from owtsweep.results.cube import Cube

    names = scheme_names(config) + (list_baselines(config) if baselines else [])
    conditions = get_conditions(config)
    return Cube.of_rows(rows, names, conditions, get_grid(config), measures=MEASURES)
