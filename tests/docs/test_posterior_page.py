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
    first, readings, evidence = read("first_look"), read("readings"), read("evidence")
    assert f"All {len(first)} readings" in PAGE
    assert f"the {(readings['seeds'] == 'own').sum()} within 25 of the best" in PAGE
    assert f"makes {(readings['seeds'] == 'shared').sum()} more" in PAGE
    for key in ("accuracy", "length", "force", "spectrum"):
        for value, lines in first.groupby(key):
            again = readings[readings[key] == value]
            own = f"{abs(again['below'].max()):.1f}" if len(again) else "not tried"
            assert f"| {abs(lines['below'].max()):.1f} | {own} |" in PAGE
    both = readings[readings["seeds"] == "own"].merge(
        first, on=["accuracy", "length", "start", "force", "spectrum"]
    )
    moved = both["log_evidence_x"] - both["log_evidence_y"]
    assert f"moved by {moved.min():.0f} to +{moved.max():.0f} against" in PAGE
    for row in evidence.itertuples():
        numbers = (row.log_evidence_again, row.log_evidence_narrow, row.log_evidence_plain)
        shown = " | ".join(f"{number:.1f}" for number in numbers)
        turns = f"{row.turns} | {row.moved:+.1f}"
        assert f"{row.log_evidence:.1f} ± {row.error:.1f} | {shown} | {turns} |" in PAGE
    kinds = ["log_evidence", "log_evidence_again", "log_evidence_narrow"]
    leader, others = evidence.iloc[0], evidence.iloc[1:]
    against = others["force"] == "against"
    level = leader["force"] == "against" and others["force"] == "level"
    rivals = {
        "the closest level reading": level,
        "another spectrum": against
        & (others["spectrum"] != leader["spectrum"])
        & (others["accuracy"] == leader["accuracy"]),
        'another "±"': against & (others["accuracy"] != leader["accuracy"]),
        "another length": against & (others["length"] != leader["length"]),
    }
    for name, rows in rivals.items():
        lead = (leader[kinds] - others.loc[rows, kinds].max()).to_numpy(dtype=float)
        assert "{} by {:.1f}, {:.1f} and {:.1f}".format(name, *lead) in PAGE
        if name == "the closest level reading":
            assert lead.min() > np.log(800.0)  # as docs/reproduction.md says
        # "called better" than a level IMU alone
        assert (lead > np.log(10.0)).all() == (name == "the closest level reading")
    own = readings[readings["seeds"] == "own"].groupby("force")["log_evidence"].max()
    assert "level ones lead: {level:.1f}, leaning {against:.1f}".format(**own) in PAGE
    (restless,) = readings[(readings["turns"] > 1) & (readings["moved"].abs() >= 1.5)].itertuples()
    assert f"1 reading never settled, {abs(restless.below):.0f} behind" in PAGE
    assert f"moved some by up to {evidence['moved'].abs().max():.1f}" in PAGE


def test_tables_left_out():
    numbers = read("numbers")
    assert f"**{numbers['inside'].sum()} of 64 printed numbers" in PAGE
    width = np.exp(np.median(np.log(numbers["out_high"] / numbers["out_low"])) / 2.0)
    assert f"factor of {width:.1f} either way" in PAGE
    for row in numbers[~numbers["inside"]].itertuples():
        assert f"| {row.table} | {row.scheme} {row.measure} | {row.published:.3g} |" in PAGE
    left_out = read("left_out")
    outside = [set(row.split("; ")) for row in left_out["outside"]]
    assert not set.intersection(*outside)
    for force, missed in zip(left_out["force"], outside, strict=True):
        assert ({"7 EKF y"} if force == "against" else {"8 MKF x", "9 MKF x"}) <= missed
    assert sum("7 EKF vy" in missed for missed in outside) == 3
    assert f"{left_out['inside'].min()} to {left_out['inside'].max()}, so this" in PAGE


def test_modes():
    table = read("modes")
    reading = ["accuracy", "length", "force", "spectrum", "seeds"]
    best = read("evidence")[reading].iloc[0]
    table = table[(table[reading] == best).all(axis=1)]
    modes = table.set_index(["table", "scheme"])
    for place in ((8, "MKF"), (8, "HME1"), (9, "HME1")):
        row = modes.loc[place]
        assert f"{row['printed']:.2f}" in PAGE
        assert f"{row['low']:.2f} to {row['high']:.2f}" in PAGE
        assert row["low"] < row["printed"] < row["high"]  # "all lie inside"


def test_statements_and_their_scores():
    table, by_reading = read("statements"), read("statements_by_reading")
    greatest = by_reading.groupby(["statement", "criterion"])["probability"].max()
    for name, lines in table.groupby("statement"):
        found = lines.set_index(["source", "criterion"])["probability"]
        shown = [
            f"{found[source, 'x']:.2f}, {found[source, 'position']:.2f}"
            for source in ("posterior", "prior", "searched")
        ]
        every = greatest[name]
        shown.append(f"{every['x']:.2f}, {every['position']:.2f}")
        assert f"| {name} |" in PAGE
        assert f"{' | '.join(shown)} |" in PAGE
    for source in ("posterior", "prior", "searched"):
        for criterion in ("x", "position"):
            lines = table[(table["source"] == source) & (table["criterion"] == criterion)]
            lines = lines[lines["statement"] != "all"]
            least = 0.5 / 64  # half a record of the fewest that a source has
            score = np.log(lines["probability"].clip(least, 1.0 - least)).sum()
            assert f"{score:.1f}" in PAGE


def test_settings():
    for row in read("settings").itertuples():
        if row.width < 0.35:
            shown = f"{row.low:.1e} to {row.high:.1e} | {row.width:.2f} | {row.above:.2f} |"
            assert f"`{row.setting}` ({row.unit}) | {shown} {row.mode:.2g} |" in PAGE
    widths = read("settings")["width"]
    assert f"widths of {widths[widths > 0.35].min():.2f} or".replace("0.", ".") in PAGE
