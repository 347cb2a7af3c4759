"""The expected engine against records: every cell of a grid, every scheme, and the time it takes.

    python benchmarks/expected.py FOLDER [override ...]

runs the study twice under FOLDER, with records (200 per natural period unless overridden) and with
engine=expected, compares position and velocity MSE in both windows, and times a map of 200 x 200
cells with and without what is cached. It writes FOLDER/expected.csv, one row per cell, and prints
the worst of each scheme.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import t as student

import owtsweep
from owtsweep.config import compose
from owtsweep.studies.hub.expected import answers, cache, engine

KEYS = ["scheme", "natural_period", "amplitude", "measure", "window"]
FINE = 200


def compare(folder: Path, overrides: list[str]) -> pd.DataFrame:
    """Mean of the records, expectation, half-width of the 99.9 % interval, per cell."""
    common = [*overrides, f"results={folder}"]
    if not any(part.startswith("grid.replicates=") for part in overrides):
        common.append("grid.replicates=200")
    records = owtsweep.run(common).summary()
    found = owtsweep.run([*common, "engine=expected"]).summary()
    both = records.merge(found[[*KEYS, "mean"]], on=KEYS, suffixes=("", "_expected"))
    both = both[both["measure"].isin(["position", "velocity"])]
    wider = student.ppf(0.9995, both["n"] - 1) / student.ppf(0.975, both["n"] - 1)
    half = (both["ci_high"] - both["mean"]) * wider
    return both.assign(
        ratio=both["mean_expected"] / both["mean"],
        half_width=half / both["mean"],
        inside=(both["mean_expected"] - both["mean"]).abs() <= half,
    )


def worst(table: pd.DataFrame) -> pd.DataFrame:
    """Per window, measure and scheme: cells, largest deviation, how many miss."""
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


def time_of_map(overrides: list[str]) -> float:
    """Seconds for the map of 200 x 200 cells, configuration and imports aside."""
    config = compose([*overrides, "engine=expected"])
    periods = np.linspace(3.0, 8.0, FINE)
    amplitudes = np.geomspace(0.05, 10.0, FINE)
    names = [block.content["scheme"] for block in engine.plan(config)]
    began = time.perf_counter()
    rows = pd.concat([engine.rows(config, n, [float(p) for p in periods]) for n in names])
    known = answers.expected(rows, names, config.measures.criterion, config.measures.window)
    answers.judge(known.at(amplitudes))
    return time.perf_counter() - began


def main() -> None:
    """Run, compare, print."""
    if len(sys.argv) < 2:
        sys.exit(f"usage: python {sys.argv[0]} FOLDER [override ...]")
    folder, overrides = Path(sys.argv[1]), sys.argv[2:]
    table = compare(folder, overrides)
    table.to_csv(folder / "expected.csv", index=False)
    print(worst(table).to_string(float_format="{:.4f}".format))
    memory = time_of_map(overrides)
    cache.forget()
    files = time_of_map(overrides)
    with tempfile.TemporaryDirectory() as empty:
        os.environ["XDG_CACHE_HOME"] = empty
        cache.forget()
        nothing = time_of_map(overrides)
    print(
        f"map of {FINE} x {FINE} cells: {memory:.2f} s with curves in memory, {files:.2f} s with "
        f"curves in files, {nothing:.2f} s with nothing cached, one thread"
    )


if __name__ == "__main__":
    main()
