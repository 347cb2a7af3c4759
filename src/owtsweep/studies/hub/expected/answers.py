"""Makes the tables of a study that is run by the expected engine.

The columns are those of a study with records, but there are no confidence intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.ratios import compare_with_best
from owtsweep.results.summary import summarise
from owtsweep.results.verdicts import judge_exactly
from owtsweep.statistics.contest import Contest, contest
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import list_baselines
from owtsweep.studies.hub.describe import ask, make_cube
from owtsweep.studies.hub.measures import JUDGED, criteria

if TYPE_CHECKING:
    from owtsweep.figures.smooth_map import Field
    from owtsweep.results.conditions import Condition

#: Two schemes are distinguishable if their MSE differs by more than this, relatively. It is the
#: accuracy of the expected errors.
RESOLUTION = 1e-3
#: In grids of more cells than this, summary.csv holds only the measures that the map judges. All
#: measures would make millions of rows.
MOST_CELLS = 2000


def expect(cube: Cube, measure: str, window: str) -> Array:
    """Return the mean square errors in a cube without records, (schemes, periods, amplitudes)."""
    at = [cube.values_of(place, measure, window)[..., 0] for place in cube.outer_places()]
    return np.stack(at, axis=1)


def judge(values: Array) -> Contest:
    """Find the best scheme and the runner-up by mean square errors (schemes, periods, amplitudes).

    Schemes that agree up to rounding count as one, under the last of their names. The runner-up is
    the best scheme that does not coincide with the winner (`statistics.contest`). The results have
    the shape (periods, amplitudes).
    """
    result = contest(values.reshape(len(values), -1, 1))
    return Contest._make(each.reshape(values.shape[1:]) for each in result)


def find_winning(
    values: Array, mse_best: Array, resolution: float = RESOLUTION
) -> tuple[NDArray[np.int64], Array]:
    """Find where a baseline is better than the best scheme by more than `resolution`, relatively.

    `values` are the baselines' MSE, shape (baselines, periods, amplitudes). Return the index of the
    best baseline where it is better, else -1; and the logarithm of `mse_best` divided by that
    baseline's MSE, -inf without baselines. Shape (periods, amplitudes) each.
    """
    if not len(values):
        return np.full(mse_best.shape, -1), np.full(mse_best.shape, -np.inf)
    lead = np.log(mse_best / values.min(axis=0))
    return np.where(lead > resolution, np.argmin(values, axis=0), -1), lead


def make_field(
    axes: tuple[Condition, Condition],
    places: tuple[Array, Array],
    values: Array,
    rivals: Array,
    resolution: float = RESOLUTION,
) -> Field:
    """Judge a map of expected errors over two conditions, for `figures.smooth_map`.

    axes, places: the conditions and their values, across and upwards.
    values, rivals: the MSE of the schemes and of the baselines, shape (schemes, columns, lines).
    resolution: how much two MSE must differ, relatively, to be told apart.
    """
    from owtsweep.figures.smooth_map import Field

    judged = judge(values)
    winning, lead = find_winning(rivals, judged.mse_best, resolution)
    return Field(
        *axes,
        *places,
        values=values,
        best=np.where(winning >= 0, -1, judged.best),
        excess=100.0 * judged.difference / judged.mse_best,
        distinguishable=~(judged.difference <= resolution * judged.mse_best),
        resolution=resolution,
        baseline=winning,
        lead=lead,
    )


def tables(config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables "summary", "best_scheme" and "ratios" from rows without records.

    Confidence intervals are NaN and the number of replicates, n, is 0. In grids of more than
    `MOST_CELLS` cells, "summary" and "ratios" have only the run's criterion and window.
    """
    window, measure = config.measures.window, config.measures.criterion
    cube = make_cube(config, rows, baselines=True)
    best = best_scheme(cube, criteria(config), window, list_baselines(config))
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
    cube: Cube, criteria: Sequence[str], window: str, baselines: Sequence[str] = ()
) -> pd.DataFrame:
    """Make the table of the best scheme in every cell, by each of the `criteria`.

    The columns are those of a study with records. Two schemes are distinguishable if their mean
    square errors differ by more than `RESOLUTION`, relatively. By this rule, too, a baseline wins
    against the best scheme.
    """
    judged = {name: JUDGED[name] for name in criteria}
    table = find_best_schemes(cube, window, judged, baselines).assign(n=0)
    table["distinguishable"] = table["difference"] > RESOLUTION * table["mse_best"]
    table["verdict"] = np.where(table["distinguishable"], "won", "open")
    if baselines:
        gain = table["mse_best"] - table["mse_baseline"]
        table["baseline_wins"] = gain > RESOLUTION * table["mse_baseline"]
    return table
