"""Finds what a map names in each cell: the best scheme, or a baseline that beats every scheme."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.studies.hub import baseline_names, scheme_names
from owtsweep.studies.hub.schemes import INSTEAD

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.hub.config import HubConfig

#: Baseline -> what it is, in the note on a map.
ESTIMATES = {
    "NONE": "an estimate of zero",
    "HOLD": "the last fix",
    "DELTA": "a straight line through the last two fixes",
}

#: What a map says of baselines that have the least error in some cells, but do not win there.
TIED = (
    "the runner-up in some cells, with less error than the best scheme, but so little less that "
    "the two cannot be told apart"
)


class Winners(NamedTuple):
    """What a map of best schemes shows.

    Attributes
    ----------
    table
        Rows of the table best_scheme, one per cell. Where a baseline beats every scheme, the
        baseline is in the place of the best scheme, and the best scheme in that of the runner-up.
        Where a baseline has the least error, but cannot be told apart from the best scheme, the
        baseline is in the place of the runner-up.
    names
        The schemes, and those baselines that beat every scheme in some cell.
    notes
        A sentence on each baseline that beats every scheme in some cell, and one on each that
        cannot be told apart from the best scheme in some cell.
    """

    table: pd.DataFrame
    names: list[str]
    notes: list[str]


def find_winners(config: HubConfig, best: pd.DataFrame, criterion: str, window: str) -> Winners:
    """Find what a map shows in each cell: the best scheme, or a baseline that beats every scheme.

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
    wins = table["baseline_wins"].to_numpy(dtype=bool)
    won = table[wins]
    changed: dict[str, Any] = {
        "best": won["baseline"],
        "mse_best": won["mse_baseline"],
        "runner_up": won["best"],
        "mse_runner_up": won["mse_best"],
        "difference": won["mse_best"] - won["mse_baseline"],
        "ci_low": np.nan,
        "ci_high": np.nan,
        "distinguishable": True,
    }
    for name, values in changed.items():
        table.loc[wins, name] = values
    tied = ~wins & (table["mse_baseline"] < table["mse_best"]).to_numpy()
    close = table[tied]
    changed = {
        "runner_up": close["baseline"],
        "mse_runner_up": close["mse_baseline"],
        "difference": close["mse_baseline"] - close["mse_best"],
        "ci_low": np.nan,
        "ci_high": np.nan,
        "distinguishable": False,
    }
    for name, values in changed.items():
        table.loc[tied, name] = values
    runners_up = [name for name in baseline_names(config) if (close["baseline"] == name).any()]
    notes = [f"{name}: {TIED}." for name in runners_up]
    winning = [name for name in baseline_names(config) if (won["baseline"] == name).any()]
    return Winners(table, names + winning, explain(winning) + notes)


def explain(baselines: list[str]) -> list[str]:
    """Return a sentence on each baseline that beats every scheme somewhere on a map."""
    return [f"{name}: {ESTIMATES[name]} beats every scheme: {INSTEAD[name]}." for name in baselines]
