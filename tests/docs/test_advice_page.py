"""The numbers of docs/advice.md are those of its table."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]


def test_how_often_a_stated_error_is_that_of_many_records() -> None:
    table = pd.read_csv(ROOT / "results" / "reference" / "advised" / "advised.csv")
    page = " ".join((ROOT / "docs" / "advice.md").read_text("utf-8").split())
    inside = (table["low"] <= table["error"]) & (table["error"] <= table["high"])
    assert (inside == table["inside"]).all()
    assert inside.sum() >= 90
    said = f"on {len(table)} drawn questions of the hub study, with records of 100 s: in "
    assert f"{said}{inside.sum()} it lay inside" in page
