"""Makes the table ratios.csv: every scheme's error beside that of the best one of its cell.

A scheme that has left a contest, or failed in a record, has other records than the best one. So
means over each one's own records are not compared: the ratio is over the records that both have.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube, join_lines
from owtsweep.statistics.inference import ordered_sum

__all__ = ["compare_with_best"]

#: Columns of ratios.csv, after those of the conditions.
COLUMNS = ("criterion", "window", "scheme", "error", "ratio", "n")


def compare_with_best(
    cube: Cube, best: pd.DataFrame, criteria: Mapping[str, Criterion]
) -> pd.DataFrame:
    """Compare each scheme and baseline with the best one of its cell, over the records of both.

    Return the conditions and `COLUMNS`: `ratio` of the errors over `n` records, and `error`, the
    best one's times that, in the criterion's unit. Records after the look that decided do not
    count. Who has no record in common with the best one has no line.

    cube: the values of all schemes and baselines.
    best: the table best_scheme made of it.
    criteria: the measures that `best` judges by.
    """
    last, names = cube.names[-1], np.array(cube.schemes, dtype=object)
    parts = []
    for (name, window), judged in best.groupby(["criterion", "window"], sort=False):
        for place in cube.outer_places():
            outer = cube.name_outer(place)
            lines = judged[np.all([judged[key] == value for key, value in outer.items()], axis=0)]
            lines = lines[lines["best"].isin(cube.schemes)]
            level = pd.Index(cube.levels[-1]).get_indexer(lines[last].array)
            values = cube.values_of(place, str(name), str(window)).take(level, axis=1)
            ratio, n = _divide(values, cube, lines, criteria[str(name)])
            scheme, cell = np.nonzero(n)
            part = {
                **outer,
                last: lines[last].to_numpy()[cell],
                "criterion": name,
                "window": window,
                "scheme": names[scheme],
                "error": (lines["error_best"].to_numpy() * ratio)[scheme, cell],
                "ratio": ratio[scheme, cell],
                "n": n[scheme, cell],
            }
            parts.append(pd.DataFrame(part))
    return join_lines(parts, [*cube.names, *COLUMNS])


def _divide(
    values: Array, cube: Cube, lines: pd.DataFrame, criterion: Criterion
) -> tuple[Array, NDArray[np.int64]]:
    """Return the errors' ratios and the numbers of records that they are over, (schemes, cells).

    values: of schemes in the cells of `lines` of the table best_scheme, (schemes, cells, records).
    """
    looked = (lines["look"] > 0).to_numpy()  # without looks, a root is averaged as it is
    squares = (looked & criterion.squared) | (criterion.values == "square")
    values = np.where(looked[:, None], criterion.judge(values), values)
    of_best = values[[cube.schemes.index(name) for name in lines["best"]], np.arange(len(lines))]
    records = np.array([int(label) for label in cube.replicates])
    seen = ~looked[:, None] | (records < lines["n"].to_numpy()[:, None])
    both = np.isfinite(values) & np.isfinite(of_best) & seen
    mean, mean_of_best = (ordered_sum(np.where(both, each, 0.0)) for each in (values, of_best))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = mean / mean_of_best
        return np.where(squares, np.sqrt(ratio), ratio), both.sum(axis=-1)
