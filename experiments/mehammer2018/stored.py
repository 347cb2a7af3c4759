"""The author's stored rms errors beside those of the same tests in the study's truth."""

from __future__ import annotations

import pandas as pd

from experiments.mehammer2018.published import read_stored_tests
from owtsweep.verdicts.page import TextTable

#: A test of the author's files -> the scenario that is like it, and the figure that it is behind.
#: The scheme is KF.
LIKE = {
    "2_10%": ("noise 10 dB", "3"),
    "4_1%each": ("disturbed, R x 10", "4"),
    "10": ("delay of a step", "5"),
    "13_10": ("losses as zeros", "6"),
}
STATES = ("x", "y", "z")


def compare_stored(scores: pd.DataFrame) -> pd.DataFrame:
    """Return stored rms errors with the study's.

    Returns
    -------
    DataFrame
        One row per test and translation. Columns: test, figure, state, stored (m), scenario, mean
        over the records (m).
    """
    stored = read_stored_tests().set_index(["test", "measure", "state"])["value"]
    of_kf = scores[scores["scheme"] == "KF"]
    means = of_kf.groupby(["scenario", "measure"])["value"].mean()
    return pd.DataFrame(
        {
            "test": test, "figure": figure, "state": state,
            "stored": stored[test, "rms_error", state], "scenario": scenario,
            "mean": means.get((scenario, f"rms_{state}"), float("nan")),
        }
        for test, (scenario, figure) in LIKE.items()
        for state in STATES
    )  # fmt: skip


def show_stored(table: pd.DataFrame) -> TextTable:
    """Return the comparison as a table of texts: "stored / mean" in m."""
    rows = []
    for (test, figure, scenario), part in table.groupby(["test", "figure", "scenario"], sort=False):
        cells = [f"{s:.3g} / {m:.3g}" for s, m in zip(part["stored"], part["mean"], strict=True)]
        rows.append([str(test), str(figure), str(scenario), *cells])
    return TextTable(["author's test", "figure", "here", *STATES], rows, list(STATES))
