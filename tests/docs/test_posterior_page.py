"""The numbers of docs/research/posterior.md are those of results/reference/posterior."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).parents[2]
PAGE = " ".join((ROOT / "docs" / "research" / "posterior.md").read_text("utf-8").split())


def read(name: str) -> pd.DataFrame:
    return pd.read_csv(ROOT / "results" / "reference" / "posterior" / f"{name}.csv")


def test_readings_and_evidence():
    readings, evidence = read("readings"), read("evidence")
    assert f"All {len(readings)} readings" in PAGE
    assert (readings.head(12)["force"] == "against").all()
    for force in ("level", "coupled", "leaning"):
        below = -readings[readings["force"] == force]["below"].max()
        assert f"seeds | {below:.1f} |" in PAGE
    for row in evidence.itertuples():
        numbers = (row.log_evidence_again, row.log_evidence_narrow, row.log_evidence_plain)
        shown = " | ".join(f"{number:.1f}" for number in numbers)
        assert f"{row.log_evidence:.1f} ± {row.error:.1f} | {shown} |" in PAGE


def test_tables_left_out():
    numbers = read("numbers")
    assert f"**{numbers['inside'].sum()} of 64 printed numbers" in PAGE
    width = np.exp(np.median(np.log(numbers["out_high"] / numbers["out_low"])) / 2.0)
    assert f"factor of {width:.1f} either way" in PAGE
    for row in numbers[~numbers["inside"]].itertuples():
        assert f"| {row.table} | {row.scheme} {row.measure} | {row.published:.3g} |" in PAGE


def test_statements_and_their_scores():
    table = read("statements")
    for name, lines in table.groupby("statement"):
        found = lines.set_index(["source", "criterion"])["probability"]
        shown = [
            f"{found[source, 'x']:.2f}, {found[source, 'position']:.2f}"
            for source in ("posterior", "prior", "tuning=paper")
        ]
        assert f"| {name} |" in PAGE
        assert " | ".join(shown) in PAGE
    for source in ("posterior", "prior", "tuning=paper"):
        for criterion in ("x", "position"):
            lines = table[(table["source"] == source) & (table["criterion"] == criterion)]
            least = 0.5 / 64  # half a record of the fewest that a source has
            score = np.log(lines["probability"].clip(least, 1.0 - least)).sum()
            assert f"{score:.1f}" in PAGE


def test_settings():
    for row in read("settings").itertuples():
        assert f"`{row.setting}`" in PAGE
        assert f"{row.low:.1e} to {row.high:.1e} | {row.width:.2f} |" in PAGE
