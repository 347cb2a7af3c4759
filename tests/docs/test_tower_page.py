"""The numbers of docs/tower.md are those of the tables."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "results" / "reference" / "tower"
PAGE = " ".join((ROOT / "docs" / "tower.md").read_text("utf-8").split())


@pytest.fixture(scope="module")
def damage() -> pd.DataFrame:
    """Damage error with `tuning=matched` by soil factor and noise, one column per scheme."""
    table = pd.read_csv(TABLES / "summary_matched.csv").query("measure == 'damage'")
    return table.pivot_table(index=["soil_factor", "noise"], columns="scheme", values="mean")


def test_damage_by_noise(damage: pd.DataFrame) -> None:
    schemes = ["AKF", "AKF_LAGGED", "AKF_MATERN32", "AKF_WHOLE", "KF_WHOLE"]
    for noise, row in damage.xs(1.0, level="soil_factor")[schemes].iterrows():
        pattern = rf"\| {f'{noise:g}'.removeprefix('0')} % \|" + r" ([\d.]+) \|" * 5
        told = re.search(pattern, PAGE)
        assert told is not None, noise
        assert [float(n) for n in told.groups()] == pytest.approx(row.to_list(), abs=0.0051)


def test_the_whole_turbine_is_better_from_three_percent_on(damage: pd.DataFrame) -> None:
    best = damage[["AKF_WHOLE", "KF_WHOLE"]].min(axis=1)
    for noise in (0.1, 0.3, 1.0, 3.0, 10.0):
        ratio = best[1.0, noise] / damage.loc[(1.0, noise), "AKF"]
        assert ratio < 1.0 if noise >= 3.0 else ratio > 0.8
    for factor in (0.8, 1.25):
        assert best[factor, 10.0] < damage.loc[(factor, 10.0), "AKF"]
    assert "From 3 % noise on that filter is better than the AKF in damage too" in PAGE


@pytest.mark.parametrize(("tuning", "decided"), [("matched", (0, 0)), ("paper", (21, 23))])
def test_how_many_cells_are_decided(tuning: str, decided: tuple[int, int]) -> None:
    best = pd.read_csv(TABLES / f"best_scheme_{tuning}.csv")
    found = best.groupby("criterion")["distinguishable"].sum()
    assert (found["damage"], found["base_moment"]) == decided
    assert "They tell the best scheme from the next in no cell of the two right maps" in PAGE
    assert "decide 21 and 23 of 35 cells" in PAGE


def test_the_table_of_errors_at_one_percent_noise() -> None:
    table = pd.read_csv(TABLES / "summary_matched.csv").query("noise == 1")
    wide = table.pivot_table(index="scheme", columns=["measure", "soil_factor"], values="mean")
    row = r"\| ([A-Z_\d]+) \| ([\d.]+)[^|]* \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|"
    told = re.findall(row, PAGE)
    assert len(told) == 10
    for scheme, *numbers in told:
        moments = [wide.loc[scheme, ("base_moment", factor)] for factor in (1.0, 0.5, 2.0)]
        found = [wide.loc[scheme, ("damage", 1.0)], *moments]
        for number, value in zip(numbers, found, strict=True):
            digits = len(number.partition(".")[2])
            assert float(number) == pytest.approx(value, abs=0.51 * 10.0**-digits), scheme
