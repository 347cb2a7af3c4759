"""Runs the case of an advice, or a changed one, and reads the errors of its contenders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Config, require
from owtsweep.results.contents import Contents
from owtsweep.results.criteria import Criterion
from owtsweep.statistics.inference import fieller, mean_and_error, t_quantile
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import Study, blame

if TYPE_CHECKING:
    import pandas as pd


class Error(NamedTuple):
    """An error in the criterion's unit, with its 95 % interval over n records."""

    value: float
    low: float
    high: float
    n: int


@dataclass(frozen=True)
class Found:
    """What a run of one cell has found.

    criterion: by which the cell was decided.
    values: Contender -> what is judged of each record, NaN where it has none.
    cells: the only row of best_scheme.csv with this criterion.
    tables: the tables of the run, by name.
    """

    run: Run
    contents: Contents
    criterion: Criterion
    values: Mapping[str, Array]
    cells: pd.DataFrame
    tables: Mapping[str, pd.DataFrame]

    def find_best(self, records: int) -> str:
        """Return the contender of least error over the first records, of those that have all."""
        able = {
            name: float(np.mean(values[:records]))
            for name, values in self.values.items()
            if np.isfinite(values[:records]).all()
        }
        require(bool(able), f"{self.run.folder}: no contender has a result; see its run.log")
        return min(able, key=lambda name: able[name])

    def measure(self, name: str, records: int | None = None) -> Error:
        """Return the error of a contender over its records, or the first of them."""
        mean, error, n = mean_and_error(self.values[name][None, :records])
        reach = t_quantile(n - 1) * error
        ends = np.concatenate([mean, np.maximum(mean - reach, 0.0), mean + reach])
        value, low, high = map(float, self.criterion.express(ends))
        return Error(value, low, high, int(n[0]))


def find(study: Study, config: Config, progress: Progress | None = None) -> Found:
    """Run one cell, as far as it is not stored.

    Raises InputError if the run cannot be made, no case succeeds, or the study makes no map.
    """
    outcome = sweep(study, config, progress=progress)
    require(bool(outcome.results), f"{outcome.run.folder}: no case has succeeded; see its run.log")
    (result,) = outcome.results.values()
    with blame(study):
        contents = outcome.run.engine.contents(config, result.tables, result.rows)
    require(
        contents is not None,
        f"study: {study.name!r} makes no map of best schemes, so it has no advice; use `sweep`",
    )
    assert contents is not None
    name, cells = next(iter(contents.criteria)), contents.cells
    return Found(
        outcome.run,
        contents,
        contents.criteria[name],
        _take_values(contents, name),
        cells[(cells["criterion"] == name) & (cells["window"] == contents.window)],
        result.tables,
    )


def _take_values(contents: Contents, name: str) -> dict[str, Array]:
    cube = contents.cube
    measure, window = cube.measures.index(name), cube.windows.index(contents.window)
    (place,) = cube.outer_places()
    judge = contents.criteria[name].judge
    return {
        scheme: judge(cube.values(i, place, [measure])[0, 0, window])
        for i, scheme in enumerate(cube.schemes)
    }


def divide(new: Array, old: Array, criterion: Criterion) -> Error:
    """Return the ratio of two errors over the records of both, with its interval by Fieller.

    new, old: What is judged of each record, shape (records,); NaN where there is none.
    """
    both = np.isfinite(new) & np.isfinite(old)
    a, b = new[both], old[both]
    ends = fieller(a, b, float(t_quantile(len(a) - 1))) if len(a) > 1 else (np.nan, np.nan)
    ratio, low, high = criterion.express(np.array([np.mean(a) / np.mean(b), *ends]))
    return Error(float(ratio), float(low), float(high), len(a))
