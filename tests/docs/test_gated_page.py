"""The numbers of docs/research/gated.md are those of its table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from experiments.gated import CELL, NEAR, WORLDS, compare, count

ROOT = Path(__file__).parents[2]
TABLE = pd.read_csv(ROOT / "results" / "reference" / "gated" / "gated.csv")
PAGE = (ROOT / "docs" / "research" / "gated.md").read_text("utf-8")


def test_the_rows_of_the_page_are_those_of_the_table() -> None:
    assert list(TABLE["world"].unique()) == list(WORLDS)
    for row in count(TABLE).itertuples():
        line = (
            f"| {row.world} | {row.near} | {row.surely} | {row.largest:.2f} | {row.highest:.2f} "
            f"| {row.nees:.2f} | {row.records} |"
        )
        assert line in PAGE


def test_what_the_page_says_of_all_worlds() -> None:
    assert (TABLE.groupby("world").size() == 60).all()
    near = TABLE[TABLE["ratio"] <= NEAR].groupby("world").size()
    assert (near >= 55).all()
    assert TABLE["high"].max() < 1.2
    far = TABLE[TABLE["ratio"] > NEAR]
    assert set(far["world"]) == {"outliers 5 %"}
    assert f"in {len(far)} cells" in PAGE
    assert (TABLE["ratio"] < 0.5).mean() > 0.5
    assert f"of {far['ratio'].max():.2f}, upper limit {far['high'].max():.2f}" in " ".join(
        PAGE.split()
    )
    for cell in far[CELL].itertuples(index=False):
        assert f"{cell.natural_period:g} s, {cell.amplitude:g} m" in PAGE


def test_where_skfa_states_too_little_of_its_error() -> None:
    large = TABLE[TABLE["amplitude"] >= 2.0]
    means = large.groupby(["world", "amplitude"])["nees"].mean()
    worst = means.loc[["bursts of 5, 5 %", "red noise .1 m, 300 s"]]
    assert (round(worst.min()), round(worst.max())) == (3, 11)
    assert round(means["unknown tilt .0137 rad/m"].max(), 1) == 2.7


def test_a_cell_is_compared_with_the_best_of_all_rivals() -> None:
    own = np.array([1.0, 1.1, 0.9, 1.0, 1.2, 1.0, 0.9, 0.9])
    hme1 = own + np.array([0.0, -0.1, 0.0, -0.1, 0.0, -0.1, 0.0, -0.1])
    errors = pd.DataFrame({"SKFA": own, "HME1": hme1, "NONE": 9.0 * own, "nees": own})
    found = compare(errors)
    assert (found["rival"], found["records"]) == ("HME1", 8)
    assert found["ratio"] == pytest.approx(8.0 / 7.6)
    assert found["high"] > found["ratio"]
    assert found["nees"] == pytest.approx(1.0)
