"""Compare engine=expected with records in every cell of a grid, or measure the time it takes.

    python -m benchmarks.expected FOLDER [override ...]
    python -m benchmarks.expected

The first command runs the study twice under FOLDER, with records (200 per natural period unless
overridden) and with engine=expected, and compares position and velocity MSE in both windows. It
writes FOLDER/expected.csv, one row per scheme, cell, measure and window, and prints each scheme's
largest differences. The second command measures the time of a map of 200 x 200 cells, with the
schemes' error curves stored and not.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pandas as pd
from scipy.stats import t as student

import owtsweep
from benchmarks import STUDY
from benchmarks.timing import REPEATS, seconds, timed
from owtsweep.io import cache
from owtsweep.results.cube import Cube
from owtsweep.studies import compose
from owtsweep.studies.hub.expected import answers, engine
from owtsweep.studies.hub.worlds import CONDITIONS

KEYS = ["scheme", "natural_period", "amplitude", "measure", "window"]
FINE = 200


def compare(folder: Path, overrides: list[str]) -> pd.DataFrame:
    """Run the study with records and with engine=expected, and compare them cell by cell.

    Each row has the mean of the records, the expectation, their `ratio`, the `half_width` of the
    99.9 % interval of the mean relative to the mean, and whether the expectation lies `inside`.
    """
    common = [*STUDY, *overrides, f"results={folder}"]
    if not any(part.startswith("grid.replicates=") for part in overrides):
        common.append("grid.replicates=200")
    records = owtsweep.run(common).summary()
    expectations = owtsweep.run([*common, "engine=expected"]).summary()
    both = records.merge(expectations[[*KEYS, "mean"]], on=KEYS, suffixes=("", "_expected"))
    both = both[both["measure"].isin(["position", "velocity"])]
    wider = student.ppf(0.9995, both["n"] - 1) / student.ppf(0.975, both["n"] - 1)
    half = (both["ci_high"] - both["mean"]) * wider
    return both.assign(
        ratio=both["mean_expected"] / both["mean"],
        half_width=half / both["mean"],
        inside=(both["mean_expected"] - both["mean"]).abs() <= half,
    )


def worst(table: pd.DataFrame) -> pd.DataFrame:
    """Summarise the result of `compare` by window, measure and scheme.

    The columns are the number of cells, the largest |ratio - 1|, the widest interval, and the
    numbers of cells with |ratio - 1| above 3 % and with an expectation outside the interval.
    """
    miss = (table["ratio"] - 1.0).abs()
    table = table.assign(
        miss=miss,
        misses_3_percent=miss > 0.03,
        outside=~table["inside"],
    )
    return table.groupby(["window", "measure", "scheme"], sort=False).agg(
        cells=("miss", "size"),
        largest_miss=("miss", "max"),
        widest_interval=("half_width", "max"),
        over_3_percent=("misses_3_percent", "sum"),
        outside_99_9=("outside", "sum"),
    )


def map_of(overrides: Sequence[str]) -> None:
    """Compute the best-scheme map of 200 x 200 cells with engine=expected, without writing it."""
    config: Any = compose([*STUDY, *overrides, "engine=expected"])
    periods = np.linspace(3.0, 8.0, FINE)
    amplitudes = np.geomspace(0.05, 10.0, FINE)
    names = [block.content["scheme"] for block in engine.plan(config)]
    rows = engine.rows_of(config, names, [float(p) for p in periods])
    grid = {"natural_period": periods.tolist(), "amplitude": amplitudes.tolist()}
    cube = Cube.of_rows(rows, names, CONDITIONS, grid)
    answers.judge(answers.expect(cube, config.measures.criterion, config.measures.window))


@contextmanager
def nothing_known() -> Iterator[None]:
    """Hide all stored error curves, in memory and in files, inside a `with` block."""
    with tempfile.TemporaryDirectory() as empty, patch.dict(os.environ, XDG_CACHE_HOME=empty):
        cache.KEPT.clear()
        yield


def measure(
    tunings: Sequence[str] = ("paper", "matched"), repeats: int = REPEATS
) -> list[dict[str, Any]]:
    """Measure the seconds that the map takes; return one row per tuning.

    The error curves are in memory, in files (medians of `repeats`), or not stored (once). Kernels
    are compiled before.
    """
    with nothing_known():
        map_of([f"tuning={tunings[-1]}"])
    rows = []
    for tuning in tunings:
        work = partial(map_of, [f"tuning={tuning}"])

        def from_files(work: Callable[[], None] = work) -> None:
            cache.KEPT.clear()
            work()

        with nothing_known():
            nothing = timed(work)[1].wall
            files = seconds(from_files, repeats=repeats)
            memory = seconds(work, repeats=repeats)
        rows.append({"tuning": tuning, "memory": memory, "files": files, "nothing": nothing})
    return rows


def main() -> None:
    """Compare with records if the command line names a folder; otherwise measure the time."""
    if len(sys.argv) < 2:
        for row in measure():
            print(row)
        return
    folder, overrides = Path(sys.argv[1]), sys.argv[2:]
    table = compare(folder, overrides)
    table.to_csv(folder / "expected.csv", index=False)
    print(worst(table).to_string(float_format="{:.4f}".format))


if __name__ == "__main__":
    main()
