"""The published numbers as this package hands them out, and beside a run's."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
import pytest

from experiments.ren2019 import published
from experiments.ren2019 import tables_6_to_9 as tables
from experiments.ren2019.figures import sum_printed


@pytest.fixture
def summary() -> pd.DataFrame:
    """A run that gives twice what is printed at 8 s, with every period a last bit off."""
    print_ = published.mse_tables().query("natural_period == 8")
    run = print_.drop(columns=["table", "note"]).rename(columns={"published": "mean"})
    run["mean"] *= 2.0
    run["natural_period"] = math.nextafter(8.0, 9.0)
    run = run.assign(window="full", ci_low=run["mean"] * 0.9, ci_high=run["mean"] * 1.1, n=20)
    return pd.concat([run, run.assign(window="settled", mean=0.0)])


def test_tables_hold_what_is_printed():
    table = published.mse_tables()
    columns = ["table", "natural_period", "amplitude", "scheme", "measure", "published", "note"]
    assert list(table.columns) == columns
    assert len(table) == 4 * 4 * 4
    value = table.set_index(["table", "scheme", "measure"])["published"]
    assert value[6, "EKF", "x"] == 5.98e-3
    assert value[7, "HME2", "vy"] == 0.52e-3
    assert value[8, "MKF", "y"] == 3.89e-3
    assert value[9, "HME2", "x"] == 13.61e-3
    conditions = table.groupby("table")[["natural_period", "amplitude"]].agg(["min", "max"])
    assert conditions.to_numpy().tolist() == [
        [4.0, 4.0, 0.2, 0.2],
        [8.0, 8.0, 0.2, 0.2],
        [8.0, 8.0, 1.0, 1.0],
        [3.0, 3.0, 2.0, 2.0],
    ]


def test_the_misprint_is_noted_at_its_own_number_only():
    noted = published.mse_tables().query("note != ''")
    assert noted[["table", "scheme", "measure"]].to_numpy().tolist() == [[7, "EKF", "vx"]]
    assert "misprint" in noted["note"].iloc[0]


def test_spectrum_and_sensors():
    folder = Path(tables.__file__).parent
    spectrum = pd.read_csv(folder / "ren2019_table4_spectrum.csv")
    spectrum = spectrum.astype({"natural_period_s": float}).set_index("natural_period_s")
    assert spectrum.loc[4.0].tolist() == [1.83e-6, -0.50, 0.062]
    sensors = pd.read_csv(folder / "ren2019_table5_sensors.csv")
    sensors = sensors.set_index("parameter")["value"].astype(float)
    assert sensors["gnss_accuracy"] == 0.03
    assert sensors["gnss_delay"] == 0.2


def test_marks_are_sums_of_two_axes():
    marks = sum_printed().set_index(["table", "scheme", "measure"])
    assert len(marks) == 4 * 4 * 2
    each = published.mse_tables().set_index(["table", "scheme", "measure"])["published"]
    assert marks.loc[(8, "MKF", "position"), "value"] == each[8, "MKF", "x"] + each[8, "MKF", "y"]
    noted = marks[marks["note"] != ""]
    assert noted.index.tolist() == [(7, "EKF", "velocity")]
    assert noted["note"].tolist() == published.mse_tables().query("note != ''")["note"].tolist()


def test_reproduced_numbers_stand_beside_the_published(summary):
    table = tables.tables_6_to_9(summary, window="full")
    columns = ["table", "natural_period", "amplitude", "scheme", "measure"]
    columns += ["published", "reproduced", "ci_low", "ci_high", "ratio", "note"]
    assert list(table.columns) == columns
    assert len(table) == 64
    inside = table[table["natural_period"] == 8.0]
    assert inside["ratio"].to_numpy() == pytest.approx(2.0)
    assert (inside["ci_low"] < inside["reproduced"]).all()
    outside = table[table["natural_period"] != 8.0]
    assert outside[["reproduced", "ci_low", "ci_high", "ratio"]].isna().all(axis=None)
    assert set(outside["note"]) == {"not in this run"}


def test_markdown_shows_four_tables(summary):
    text = tables.to_markdown(tables.tables_6_to_9(summary, window="full"))
    assert text.count("### Table") == 4
    assert "### Table 8: natural period 8 s, amplitude 1 m" in text
    assert "| MKF | 7.81e-3 → 1.56e-2 (2.00) |" in text
    assert "| EKF | 5.23e-1 → – |" in text
    assert "misprint" in text
    assert text.count("–: not in this run") == 2  # tables 6 and 9
    widths = {line.count("|") for line in text.splitlines() if line.startswith("|")}
    assert widths == {6}
