"""Makes the table summary.csv: means over the replicates with their confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from owtsweep.results.conditions import order_values, sort_lines
from owtsweep.results.cube import Cube, join_lines
from owtsweep.results.status import OK, UNABLE
from owtsweep.statistics.inference import mean_and_error, t_quantile

__all__ = ["summarise"]


def summarise(cube: Cube, *, shared: bool = False) -> pd.DataFrame:
    """Compute the mean of each measure over the replicates, with its 95 % confidence interval.

    If `shared`, only the replicates count that all schemes of a cell have, so that means can stand
    side by side where some schemes have left a contest.

    Return the columns scheme, conditions, measure, window, mean, ci_low, ci_high and n, sorted by
    the first four. `ci_low` and `ci_high` are the ends of the interval by Student's t, NaN for a
    single replicate. `n` is the number of replicates that the scheme finished. If a scheme was
    unable to work under some conditions, there are also the columns `status` and `reason`, and a
    line without measure for it.
    """
    labels = ["scheme", *cube.names, "measure", "window"]
    columns = [*labels, "mean", "ci_low", "ci_high", "n"]
    parts = []
    counted = {place: cube.find_shared(place) for place in cube.outer_places() if shared}
    for i in range(len(cube.schemes)):
        for place in cube.outer_places():
            values = cube.values(i, place)
            if shared:
                values = np.where(counted[place][:, None, None], values, np.nan)
            with np.errstate(invalid="ignore"):  # 0 / 0 in cells without values
                mean, error, n = mean_and_error(values)
            cells = np.nonzero(n)
            mean, error, n = mean[cells], error[cells], n[cells]
            margin = t_quantile(n - 1) * error
            table = cube.label(i, place, cells)
            table |= {"mean": mean, "ci_low": mean - margin, "ci_high": mean + margin, "n": n}
            parts.append(pd.DataFrame(table, columns=columns))
    whole = join_lines(parts, columns)
    if cube.unable.empty:
        return whole
    order: dict[str, Sequence[object]] = {"scheme": cube.schemes}
    for name, levels in zip(cube.names, cube.levels, strict=True):
        order[name] = order_values([*levels, *cube.unable[name]], levels)
    whole = whole.assign(status=OK, reason="")
    lines = cube.unable.assign(measure="", window="", n=0, status=UNABLE)
    lines = lines.reindex(columns=whole.columns)
    return sort_lines(pd.concat([whole, lines]) if len(whole) else lines, order)
