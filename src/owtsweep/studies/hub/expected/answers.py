"""Makes the tables of a study that is run by the expected engine.

The columns are those of a study with records, but there are no confidence intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import Grid
from owtsweep.results.cube import Cube
from owtsweep.results.ratios import compare_with_best
from owtsweep.results.status import OK
from owtsweep.results.summary import summarise
from owtsweep.results.superposition import superpose
from owtsweep.results.verdicts import judge_exactly
from owtsweep.statistics.contest import Contest, agree, contest, group_coinciding
from owtsweep.studies.hub.conditions import JUDGED, criteria, find_world
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import ask, make_cube
from owtsweep.studies.hub.listed import list_baselines, scheme_names
from owtsweep.studies.hub.world import CONDITIONS

#: Two schemes are distinguishable if their MSE differs by more than this, relatively. It is the
#: accuracy of the expected errors.
RESOLUTION = 1e-3
#: In grids of more cells than this, summary.csv holds only the measures that the map judges. All
#: measures would make millions of rows.
MOST_CELLS = 2000


@dataclass(frozen=True)
class Expected:
    """The expected mean square errors of schemes, of one measure in one window.

    At amplitude N (m) the expected mean square error is N^2 motion + noise.

    periods: natural periods, s, increasing.
    motion, noise: mean square errors due to motion of 1 m and due to noise, shape
        (schemes, periods) each.
    """

    schemes: tuple[str, ...]
    periods: Array
    motion: Array
    noise: Array

    def at(self, amplitudes: Array) -> Array:
        """Compute the mean square errors at n amplitudes (m), shape (schemes, periods, n)."""
        N = np.asarray(amplitudes, dtype=float)
        return np.asarray(superpose(self.motion[..., None], 0.0, self.noise[..., None], N))


def expected(rows: pd.DataFrame, schemes: Sequence[str], measure: str, window: str) -> Expected:
    """Select one measure and one window from the rows that the expected engine has made.

    Failed rows are left out, and so are rows of one amplitude, as SKF has, and schemes without
    other rows.
    """
    rows = rows[rows["amplitude"].isna()]
    # plain text instead of the store's categories, which sort differently
    rows = rows.astype(dict.fromkeys(("scheme", "measure", "window"), object))
    used = rows[(rows["status"] == OK) & (rows["measure"] == measure) & (rows["window"] == window)]
    present = tuple(name for name in schemes if (used["scheme"] == name).any())
    tables: list[pd.DataFrame] = [
        used.pivot(index="scheme", columns="natural_period", values=what).reindex(list(present))
        for what in ("motion", "noise")
    ]
    periods = tables[0].columns.to_numpy(dtype=float)
    return Expected(present, periods, tables[0].to_numpy(float), tables[1].to_numpy(float))


def judge(values: Array) -> Contest:
    """Find the best scheme and the runner-up by mean square errors (schemes, periods, amplitudes).

    Schemes that agree up to rounding count as one, under the last of their names. The runner-up is
    the best scheme that does not coincide with the winner (`statistics.contest`). The results have
    the shape (periods, amplitudes).
    """
    result = contest(values.reshape(len(values), -1, 1))
    return Contest._make(each.reshape(values.shape[1:]) for each in result)


def find_winning(values: Array, mse_best: Array) -> tuple[NDArray[np.int64], Array]:
    """Find where a baseline is better than the best scheme by more than `RESOLUTION`.

    `values` are the baselines' MSE, shape (baselines, periods, amplitudes). Return the index of the
    best baseline where it is better, else -1; and the logarithm of `mse_best` divided by that
    baseline's MSE, -inf without baselines. Shape (periods, amplitudes) each.
    """
    if not len(values):
        return np.full(mse_best.shape, -1), np.full(mse_best.shape, -np.inf)
    lead = np.log(mse_best / values.min(axis=0))
    return np.where(lead > RESOLUTION, np.argmin(values, axis=0), -1), lead


def tables(config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables "summary", "best_scheme" and "ratios" from rows without records.

    Confidence intervals are NaN and the number of replicates, n, is 0. In grids of more than
    `MOST_CELLS` cells, "summary" and "ratios" have only the run's criterion and window.
    """
    window, measure = config.measures.window, config.measures.criterion
    best = best_scheme(
        rows, scheme_names(config), criteria(config), find_world(config).get_grid(config), window,
        list_baselines(config),
    )  # fmt: skip
    if len(config.grid.amplitude) * len(config.grid.natural_period) > MOST_CELLS:
        rows = rows[(rows["measure"] == measure) & (rows["window"] == window)]
    cube = make_cube(config, rows, baselines=True)
    summary = summarise(cube).assign(n=0)
    if config.grid.decides:
        best = judge_exactly(best, summary, ask(config))
    there = best[best["criterion"].isin(cube.measures)]
    ratios = compare_with_best(cube, there, JUDGED).assign(n=0)
    return {"summary": summary, "best_scheme": best, "ratios": ratios}


def best_scheme(
    rows: pd.DataFrame,
    schemes: Sequence[str],
    criteria: Sequence[str],
    grid: Grid,
    window: str,
    baselines: Sequence[str] = (),
) -> pd.DataFrame:
    """Make the table of the best scheme in every cell, by each of the `criteria`.

    The columns are those of a study with records. Two schemes are distinguishable if their mean
    square errors differ by more than `RESOLUTION`, relatively. By this rule, too, a baseline wins
    against the best scheme.
    """
    cube = Cube.of_rows(rows, [*schemes, *baselines], CONDITIONS, grid)
    judged = {name: JUDGED[name] for name in criteria}
    table = find_best_schemes(cube, window, judged, baselines).assign(n=0)
    table["distinguishable"] = table["difference"] > RESOLUTION * table["mse_best"]
    table["verdict"] = np.where(table["distinguishable"], "won", "open")
    if baselines:
        gain = table["mse_best"] - table["mse_baseline"]
        table["baseline_wins"] = gain > RESOLUTION * table["mse_baseline"]
    return table


def coinciding(
    rows: pd.DataFrame, schemes: Sequence[str], window: str, criteria: Sequence[str]
) -> list[tuple[str, ...]]:
    """Find groups of schemes whose errors from motion and from noise coincide by all criteria."""
    curves = [expected(rows, schemes, criterion, window) for criterion in criteria]
    names = curves[0].schemes
    marks = np.concatenate([np.hstack([one.motion, one.noise]) for one in curves], axis=1)
    return group_coinciding(names, lambda i, j: bool(np.all(agree(marks[i], marks[j]))))
