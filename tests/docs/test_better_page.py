"""The numbers of docs/better.md, its research, and docs/hub.md on SKFA are the tables'."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from experiments.switching import BASE
from owtsweep.studies import compose

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "results" / "reference" / "better"
NAMES = ("research/bounds", "better", "research/hold", "research/switching", "outliers")
PAGE = "\n".join((ROOT / "docs" / f"{name}.md").read_text("utf-8") for name in NAMES)
HUB = (ROOT / "docs" / "hub.md").read_text("utf-8")
FOUR = ["EKF", "MKF", "HME1", "HME2"]


@pytest.fixture(scope="module")
def errors() -> pd.DataFrame:
    """Position MSE by natural period and amplitude, one column per scheme, and the bounds."""
    table = pd.read_csv(TABLES / "efficiency.csv")
    table = table[table["measure"] == "position"]
    cells = ["natural_period", "amplitude"]
    wide = table.pivot_table(index=cells, columns="scheme", values="mse")
    bounds = table.drop_duplicates(cells).set_index(cells)[["bound_a", "bound_b"]]
    return wide.join(bounds).assign(four=wide[FOUR].min(axis=1))


def find(pattern: str, text: str = PAGE) -> list[float]:
    """Return the numbers that a pattern's groups match; text may break lines at any blank."""
    matched = re.search(pattern.replace(" ", r"\s+"), text)
    assert matched is not None, pattern
    return [float(number) for number in matched.groups()]


def test_skfa_against_bound_four_and_skf(errors: pd.DataFrame) -> None:
    over_least = errors["SKFA"] / errors["bound_b"]
    for text in (PAGE, HUB):
        told = find(
            r"mean square error is ([\d.]+) to ([\d.]+) times the least that is possible", text
        )
        assert told == pytest.approx([over_least.min(), over_least.max()], abs=0.006)
    gain = errors["four"] / errors["SKFA"]
    assert gain.min() > 1.0
    for amplitude, pattern in (
        (0.05, r"is (\d+) to (\d+) times \(3 to 8 s\) smaller"),
        (0.2, r"(\d+) to (\d+) times at \.2 m"),
        (1.0, r"times at \.2 m, (\d+\.\d) to (\d+\.\d) times at 1 m"),
    ):
        at = gain.xs(amplitude, level="amplitude")
        assert find(pattern) == pytest.approx([at.max(), at.min()], rel=0.05)
    worse = errors["SKFA"] / errors["SKF"]
    least, most = find(r"better still by (\d+) to (\d+) %")
    assert np.round(100.0 * (worse.min() - 1.0)) == least
    assert np.round(100.0 * (worse.max() - 1.0)) == most
    assert (worse <= 1.3).all()  # wanted in 50 of 60 cells
    assert (errors["SKFA"] <= 1.05 * errors["HME1"]).all()


def test_skf_against_bound_and_all_others(errors: pd.DataFrame) -> None:
    near = errors["SKF"] / errors["bound_b"]
    assert find(r"(\.\d+) to (1\.\d+) times bound \(b\)") == pytest.approx(
        [near.min(), near.max()], abs=0.006
    )
    (count,) = find(r"within 3 % in (\d+) of them")
    assert (np.abs(near - 1.0) < 0.03).sum() == count
    others = errors[[*FOUR, "NONE", "HOLD", "DELTA"]].min(axis=1)
    assert (errors["SKF"] < others).all()
    gain = errors["four"] / errors["SKF"]
    assert (gain[gain.index.get_level_values("amplitude") <= 0.1] > 6.0).all()
    assert (gain.xs(0.2, level="amplitude") > 2.8).all()


def test_the_table_in_millimetres(errors: pd.DataFrame) -> None:
    at = 1e3 * np.sqrt(errors.xs(4.0, level="natural_period"))
    at = at.loc[[0.05, 0.2, 1.0, 10.0]]
    for words, column in {
        "best of the four": "four",
        r"no estimator \(NONE\)": "NONE",
        "SKFA, told nothing": "SKFA",
        "SKF, told the sea": "SKF",
        r"the least possible, bound \(b\)": "bound_b",
    }.items():
        number = r"([\d.]+)"
        told = find(rf"\| {words} \| {number} \| {number} \| {number} \| {number} \|")
        assert told == pytest.approx(at[column].tolist(), rel=0.035)


def test_seas_that_move() -> None:
    table = pd.read_csv(TABLES / "moving_sea.csv")
    wide = table.pivot_table(index=["sea", "amplitude"], columns="scheme", values="mse")
    ratio = wide["SKFA"] / wide["HME1"]
    assert (ratio <= 1.1).all()
    for amplitude, words in ((0.05, r"\.05 m"), (0.2, r"\.2 m"), (1.0, "1 m"), (10.0, "10 m")):
        number = r"(\d?\.\d+)"
        told = find(rf"\| {words} \| {number} \| {number} \| {number} \|\n")
        seas = ["two peaks", "moving period", "growing"]
        assert told == pytest.approx([ratio[sea, amplitude] for sea in seas], abs=0.006)


@pytest.fixture(scope="module")
def switching() -> pd.DataFrame:
    return pd.read_csv(TABLES / "switching.csv")


def find_ratios(table: pd.DataFrame, run: str) -> pd.Series[float]:
    """Return SWITCH's position error over the lesser of its two, by period and amplitude."""
    part = table[(table["run"] == run) & (table["measure"] == "position")]
    wide = part.pivot(index=["natural_period", "amplitude"], columns="scheme", values="mse")
    return wide["SWITCH"] / wide.drop(columns=["SWITCH", "HME1 - SWITCH"]).min(axis=1)


def test_switch_in_a_sea_that_grows(switching: pd.DataFrame) -> None:
    keys = ["run", "measure", "scheme"]
    at = switching.set_index(keys)[["mse", "ci_low", "ci_high"]].sort_index()
    number = r"\**([\d.e-]+)\**"
    run = at.loc["growing", "position"]
    told = find(
        rf"{number} in the growing and falling sea, HME1 {number} \(the difference is "
        rf"{number} \[{number}, {number}\]\), MKF {number}\."
    )
    gain = run.loc["HME1 - SWITCH"].tolist()
    means = run["mse"]
    assert told == pytest.approx([means["SWITCH"], means["HME1"], *gain, means["MKF"]], rel=0.006)
    assert set(switching["records"]) == {4}


def test_switch_in_seas_that_do_not_move(switching: pd.DataFrame) -> None:
    ratio = find_ratios(switching, "steady")
    assert ratio.xs(0.1, level="amplitude").to_numpy() == pytest.approx(1.0, abs=5e-4)
    (most,) = find(r"at 0\.5 m it has at most ([\d.]+) times HME1's error")
    assert round(ratio.xs(0.5, level="amplitude").max(), 3) == most
    at_tenth = switching.query("run == 'steady' and amplitude == 0.1 and measure == 'position'")
    means = at_tenth.groupby("scheme")["mse"].mean()
    told = find(r"(2\.\de-3) in place of HME1's (2\.\de-3)")
    assert told == pytest.approx([means["SWITCH"], means["HME1"]], abs=0.05e-3)


def test_the_boundary_that_switch_computes() -> None:
    table = pd.read_csv(TABLES / "switching_boundary.csv")
    told = find(r"([\d.]+), ([\d.]+), ([\d.]+), ([\d.]+) m at 3, 4, 6, 8 s")
    assert told == table["boundary"].round(2).tolist()


def test_the_conditions_and_settings_of_switch() -> None:
    config: Any = compose(BASE)
    told = find(r"(\d+) records of (\d+) s per cell, seed (\d+), errors after the first (\d+) s\.")
    assert told == [
        config.grid.replicates, config.record.duration, config.seed, config.measures.settling_time,
    ]  # fmt: skip
    switch = config.switch
    assert find(r"\(`switch.memory`, (\d+) s\)") == [switch.memory]
    assert find(r"`switch.crest` \((\d\.\d)\) times rms\(position\)") == [switch.crest]
    up, down = find(r"upwards at (\d\.\d) times the boundary, .* divided by (\d\.\d)\.")
    assert up == down == switch.hysteresis
    assert find(r"weighted mean within (\d) s\.") == [switch.blend]


@pytest.fixture(scope="module")
def departures() -> pd.DataFrame:
    """MSE and other columns of SKFA and its rivals where its assumptions do not hold."""
    return pd.read_csv(TABLES / "departures.csv")


def test_what_to_run_in_which_world(departures: pd.DataFrame) -> None:
    wide = departures.pivot_table(
        index=["departure", "amplitude"], columns="scheme", values="mse"
    )  # fmt: skip
    table = PAGE.partition("## What to run in which world")[2].partition("## ")[0]
    rows = [[cell.strip() for cell in line.split("|")] for line in table.splitlines()]
    told = [[float(cell) for cell in row[3:7]] for row in rows if len(row) == 9 and " m" in row[2]]
    names = [name for name in departures["departure"].unique() if name[:4] not in ("plan", "seed")]
    right = 1e3 * np.sqrt(wide.loc[names][["NONE", "MKF", "HME1", "SKFA"]])
    np.testing.assert_allclose(told, right, atol=0.51)


def test_covariance_of_skfa_on_the_plant(departures: pd.DataFrame) -> None:
    seas = departures[departures["departure"] == "plant"].set_index(["hs", "tp", "scheme"])
    nees = seas.xs("SKFA", level="scheme")["nees"]
    assert find(
        r"NEES (\d\.\d) to (\d\.\d) per degree of freedom on the plant, largest at Tp 8"
    ) == pytest.approx([nees.min(), nees.max()], abs=0.06)
    assert nees.idxmax()[1] == 8.0
    wide = seas["mse"].unstack("scheme")
    ratio = wide["SKFA"] / wide["HME1"]
    assert find(r"SKFA has (\.\d+) to (\.\d+) of HME1's error") == pytest.approx(
        [ratio.min(), ratio.max()], abs=0.006
    )


def test_other_seeds_are_told(departures: pd.DataFrame) -> None:
    fresh = departures[departures["departure"].str.startswith("seed")]
    skfa = fresh[fresh["scheme"] == "SKFA"]
    wide = fresh.pivot_table(
        index=["departure", "natural_period", "amplitude"], columns="scheme", values="mse"
    )
    over_told = 100.0 * (wide["SKFA"] / wide["SKF"]) - 100.0
    least, worst = over_told.min(), over_told.max()
    over_least = [1.0 / skfa["efficiency"].max(), 1.0 / skfa["efficiency"].min()]
    low, high = find(r"SKFA has ([\d.]+) to ([\d.]+) times the least error")
    cheap, cost = find(r"SKF is better by (\d+) to (\d+) %")
    assert [low, high] == pytest.approx(over_least, abs=0.006)
    assert [cheap, cost] == pytest.approx([least, worst], abs=0.6)
    low, high = find(r"with two other seeds ([\d.]+) to ([\d.]+) times", HUB)
    (cost,) = find(r"with other seeds up to (\d+) %", HUB)
    assert [low, high] == pytest.approx(over_least, abs=0.006)
    assert cost == pytest.approx(worst, abs=0.6)
