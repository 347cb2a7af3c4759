"""Which cells change their best scheme, and where the panels of runs stand."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from owtsweep.comparing.changes import compare_cells, compare_schemes
from owtsweep.comparing.comparison import Candidate, Comparison, Pair
from owtsweep.comparing.maps import arrange


def test_a_change_needs_both_gaps_and_holm_counts_every_cell():
    index = pd.MultiIndex.from_product(
        [["P", "Q"], [1.0], [1.0, 2.0, 3.0]], names=["scheme", "natural_period", "amplitude"]
    )
    noise = 1e-3 * np.arange(6.0)

    def table(gaps):  # Q less P in the three cells
        return pd.DataFrame([np.ones(6)] * 3 + [1.0 + g + noise - noise.mean() for g in gaps],
                            index=index)  # fmt: skip

    first, second = table([0.1, 0.1, 0.0003]), table([-0.1, 0.1, -0.1])
    best = {(1.0, N): "P" for N in (1.0, 2.0, 3.0)}
    after = {(1.0, 1.0): "Q", (1.0, 2.0): "P", (1.0, 3.0): "Q"}
    rows = compare_cells(first, second, best, after, paired=True)
    assert [row["amplitude"] for row in rows] == [1.0, 3.0]
    assert [row["established"] for row in rows] == [True, False]
    assert rows[0]["change"] == pytest.approx(-0.2)


@pytest.mark.parametrize(
    ("paired", "counts"), [(True, [(2, 2), (1, 1)]), (False, [(3, 3), (1, 3)])]
)
def test_pairs_count_the_replicates_that_both_runs_have(paired, counts):
    index = pd.MultiIndex.from_product([["P"], [1.0, 2.0, 3.0]], names=["scheme", "period"])
    nan = np.nan
    first = pd.DataFrame([[1.0, 2.0, nan, 4.0], [1.0, nan, nan, nan], [nan] * 4], index=index)
    second = pd.DataFrame([[2.0, 4.0, 9.0, nan], [3.0, nan, 1.0, 1.0], [1.0] * 4], index=index)
    rows = compare_schemes(first, second, paired=paired)
    assert [(row["n_from"], row["n_to"]) for row in rows] == counts


def comparison(values: list[dict]) -> Comparison:
    runs = tuple(Candidate("", "", None, pd.DataFrame(), own) for own in values)
    return Comparison(tuple(values[0]), (), runs, (Pair(0, 1, ""),))


def test_panels_put_the_first_key_across_and_leave_holes():
    grid = [{"a": a, "b": b} for a in (1.0, 2.0) for b in (5.0, 6.0, 7.0)]
    panels = arrange(comparison(grid[:-1]))
    assert panels == [[0, 3], [1, 4], [2, None]]
    one = arrange(comparison([{"a": float(i)} for i in range(6)]))
    assert one == [[0, 1, 2, 3], [4, 5, None, None]]
    assert arrange(comparison([{"a": 1, "b": 2, "c": i} for i in range(2)])) is None
    assert arrange(comparison([{"a": float(i)} for i in range(31)])) is None


def test_tables_hold_the_swept_values_whole():
    values = {"walk": 1.2345678901234e-05, "rate": 5, "grid": list(range(40)), "flag": True}
    values |= {"name": "x" * 50, "none": None}
    (run,) = comparison([values]).runs
    assert run.written == {
        "walk": 1.2345678901234e-05, "rate": 5, "grid": str(list(range(40))).replace(" ", ""),
        "flag": "true", "name": "x" * 50, "none": "null",
    }  # fmt: skip
    assert run.shown["walk"] == "1.23456789e-05"
    assert run.shown["name"].endswith("...")
