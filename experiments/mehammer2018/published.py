"""The numbers in the author's files, and beside them those of the same tests in our truth.

What the paper says stands in claims.toml.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from experiments.single_record import place_print, show_chance
from owtsweep.verdicts.page import TextTable

HERE = Path(__file__).parent
#: A test of the author's files -> the scenario that is like it, and the figure that it is behind.
#: The scheme is KF.
LIKE = {
    "2_10%": ("noise 10 dB", "3"),
    "4_1%each": ("disturbed, R x 10", "4"),
    "10": ("delay of a step", "5"),
    "13_10": ("losses as zeros", "6"),
}
STATES = ("x", "y", "z")


def read_stored_tests() -> pd.DataFrame:
    """Read the rms errors and r^2 that the author's files hold of 22 tests, 12 states each.

    Columns: test, measure (rms_error or r2), state (x ... r: positions and velocities; m, rad, and
    per s), value.
    """
    return pd.read_csv(HERE / "stored_tests.csv", dtype={"test": str})


def read_author_record() -> pd.DataFrame:
    """Read what the author's record of the buoy and SIMA's record say (reference [12]).

    Made by author_record.py, which says how. Columns: state (x, y, z), measure (rms_error and
    drift, m; velocity_rms and high, m/s; lag, ms), estimate, value.
    """
    return pd.read_csv(HERE / "author_record.csv")


def compare_stored(scores: pd.DataFrame) -> pd.DataFrame:
    """Return stored rms errors with the study's.

    Returns
    -------
    DataFrame
        One row per test and translation. Columns: test, figure, state, stored (m), scenario, mean
        over the records (m), and chance and agrees: whether one record could have given the stored
        number (`single_record`).
    """
    stored = read_stored_tests().set_index(["test", "measure", "state"])["value"]
    of_kf = scores[scores["scheme"] == "KF"]
    groups = of_kf.groupby(["scenario", "measure"])["value"]
    values = {key: group.to_numpy() for key, group in groups}
    rows = []
    for test, (scenario, figure) in LIKE.items():
        for state in STATES:
            number = stored[test, "rms_error", state]
            found = values.get((scenario, f"rms_{state}"), np.array([np.nan]))
            place = place_print(number, number, found)
            rows.append(
                {
                    "test": test, "figure": figure, "state": state, "stored": number,
                    "scenario": scenario, "mean": found.mean(), "chance": place.chance,
                    "agrees": place.agrees,
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def show_stored(table: pd.DataFrame) -> TextTable:
    """Return the comparison as a table of texts: "stored / mean (chance)" in m."""
    rows = []
    for (test, figure, scenario), part in table.groupby(["test", "figure", "scenario"], sort=False):
        cells = [
            f"{stored:.3g} / {mean:.3g} ({show_chance(chance)})"
            for stored, mean, chance in zip(
                part["stored"], part["mean"], part["chance"], strict=True
            )
        ]
        rows.append([str(test), str(figure), str(scenario), *cells])
    return TextTable(["author's test", "figure", "here", *STATES], rows, list(STATES))
