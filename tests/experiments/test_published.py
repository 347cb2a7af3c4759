"""The published numbers as this package hands them out."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from experiments.ren2019 import figures
from experiments.ren2019.figures import sum_printed
from owtsweep.studies.readings import published


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
    folder = Path(figures.__file__).parent
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
