"""The best baseline of a cell against the best scheme, by naive computations."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from hub_rows import make_cube, values_of
from naive_holm import naive_holm
from scipy import stats

from owtsweep.results.best_scheme import BASELINE_COLUMNS, find_best_schemes


def compare(cells: dict[float, dict[str, list[float]]]) -> pd.DataFrame:
    """The table of cells (by amplitude); NONE and HOLD are baselines."""
    values = pd.concat([values_of(samples, amplitude=a) for a, samples in cells.items()])
    cube = make_cube(values, ["MKF", "HME1", "NONE", "HOLD"])
    return find_best_schemes(cube, "full", ["position"], ["NONE", "HOLD"]).set_index("amplitude")


def test_the_best_baseline_wins_by_a_paired_test_over_the_map() -> None:
    random = np.random.default_rng(3)
    cells = {}
    for amplitude, level in zip(
        (0.1, 0.2, 0.5, 1.0, 2.0), (0.2, 0.9, 0.985, 1.0, 3.0), strict=True
    ):
        common = random.normal(1.0, 0.2, 12)  # of the record: cancels in pairs
        cells[amplitude] = {
            "MKF": list(common + random.normal(0.0, 0.02, 12)),
            "HME1": list(common + 0.1),
            "NONE": list(level * common + random.normal(0.0, 0.02, 12)),
            "HOLD": list(common + 5.0),
        }
    table = compare(cells)
    p = []
    for amplitude, row in table.iterrows():
        samples = cells[float(str(amplitude))]
        assert row["baseline"] == "NONE"
        assert row["mse_baseline"] == pytest.approx(np.mean(samples["NONE"]))
        assert row["best"] in ("MKF", "HME1")
        p.append(stats.ttest_rel(samples[row["best"]], samples["NONE"]).pvalue)
    less = table["mse_baseline"] < table["mse_best"]
    assert list(table["baseline_wins"]) == list(np.array(naive_holm(p, 0.05)) & less)
    assert table["baseline_wins"].nunique() == 2


def test_only_records_that_all_schemes_finished_count() -> None:
    nan = math.nan
    cells = {
        1.0: {
            "MKF": [1.0, 1.1, nan, 1.2], "HME1": [2.0, 2.1, 2.2, 2.3],
            "NONE": [0.1, 0.2, 90.0, 0.3], "HOLD": [0.5, 0.5, 0.5, 0.5],
        },
        2.0: {
            "MKF": [1.0, 1.1, 1.3, 1.2], "HME1": [2.0, 2.1, 2.2, 2.3],
            "NONE": [0.1, nan, 0.1, 0.1], "HOLD": [0.5, 0.5, 0.5, 0.5],
        },
    }  # fmt: skip
    table = compare(cells)
    assert list(table["baseline"]) == ["NONE", "HOLD"]  # one that lacks a record takes no part
    assert table["mse_baseline"].tolist() == pytest.approx([0.2, 0.5])


def test_without_baselines_there_are_no_such_columns() -> None:
    samples = {"MKF": [1.0, 2.0], "HME1": [2.0, 3.0]}
    cube = make_cube(values_of(samples), list(samples))
    assert not set(BASELINE_COLUMNS) & set(find_best_schemes(cube, "full", ["position"]).columns)
