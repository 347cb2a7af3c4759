"""The sentence on a map counts every cell once, under a scheme or under a baseline."""

from __future__ import annotations

import pandas as pd
import pytest

from owtsweep.results.best_scheme import tell_beaten, tell_winners


def make_cells(*rows: tuple[str, bool, str, bool]) -> pd.DataFrame:
    """Cells, each with best scheme, whether it is distinguishable, baseline, whether that wins."""
    return pd.DataFrame(rows, columns=["best", "distinguishable", "baseline", "baseline_wins"])


@pytest.mark.parametrize(
    ("cells", "told"),
    [
        (
            [
                ("MKF", True, "NONE", False),
                ("HME1", False, "NONE", False),
                ("HME1", True, "HOLD", False),
            ],
            "HME1 is best in 2 of 3 cells, MKF in 1; in 1 the next best cannot be told apart from "
            "the best.",
        ),
        (
            [
                ("MKF", False, "NONE", True),
                ("MKF", True, "NONE", True),
                ("HME1", True, "HOLD", True),
                ("HME1", False, "HOLD", False),
            ],
            "HME1 is best in 1 of 4 cells; in 3 a baseline beats every scheme (NONE in 2, HOLD in "
            "1); in 1 the next best cannot be told apart from the best.",
        ),
        (
            [("MKF", False, "NONE", True)] * 2,
            "A baseline beats every scheme in all 2 cells (NONE in 2).",
        ),
    ],
)
def test_each_cell_is_counted_once(cells: list[tuple[str, bool, str, bool]], told: str) -> None:
    assert tell_winners(make_cells(*cells)) == told


def test_a_table_without_baselines_is_told() -> None:
    cells = pd.DataFrame({"best": ["MKF", "MKF"], "distinguishable": [True, True]})
    assert tell_winners(cells) == "MKF is best in 2 of 2 cells."


def test_a_scheme_that_is_best_nowhere_is_told_with_its_error() -> None:
    place = {"tp": [4.0, 8.0], "window": "full"}
    cells = pd.DataFrame(place | {"criterion": "position", "mse_best": [0.5, 1.0]})
    own = pd.DataFrame(place | {"scheme": "mine", "measure": "position", "mean": [1.0, 12.0]})
    others = [
        own.assign(measure="velocity", mean=99.0),
        own.assign(window="settled", mean=99.0),
        own.assign(scheme="MKF", mean=99.0),
    ]
    summary = pd.concat([own, *others])
    assert tell_beaten("mine", cells, summary, ["tp"], "m²") == (
        "mine is best in no cell: its MSE is 1 to 12 m², 2 to 12 times the least one."
    )
    failed = tell_beaten("gone", cells, summary, ["tp"], "m²")
    assert failed == "gone is best in no cell: it has no result."
