"""What docs/research/floater_reproduction.md says of the paper is what the kept tables say."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from experiments.mehammer2018.published import read_author_record, read_stored_tests

ROOT = Path(__file__).parents[2]
PAGE = " ".join((ROOT / "docs/research/floater_reproduction.md").read_text("utf-8").split())
CLAIMS = pd.read_csv(ROOT / "results" / "reference" / "floater" / "fidelity_claims.csv")


def test_verdicts_are_counted_as_the_report_does() -> None:
    worst_first = ["not reproduced", "missing", "undecided", "reproduced"]
    statements = CLAIMS[CLAIMS["statement"].str.startswith("F")]
    verdicts = statements.groupby("statement")["verdict"].agg(
        lambda each: min(each, key=worst_first.index)
    )
    counts = verdicts.value_counts()
    told = (
        f"{counts['reproduced']} are reproduced, {counts['not reproduced']} are not (F4 and F9), "
        f"and {counts['missing']} needs the author's file"
    )
    assert told in PAGE
    assert set(verdicts.index[verdicts == "not reproduced"]) == {"F4", "F9"}


def test_numbers_of_the_authors_record() -> None:
    record = read_author_record().pivot(index="state", columns=["measure", "estimate"])["value"]
    ratio = record["velocity_rms", "KF"] / record["velocity_rms", "OBSERVER"]
    assert "{:.1f}, {:.1f} and {:.1f} times the observer's error".format(*ratio) in PAGE
    assert "{:.0f}, {:.0f} and {:.0f} ms".format(*record["lag", "OBSERVER"]) in PAGE
    assert "{:.1f}, {:.1f} and {:.1f} m in 500 s".format(*record["drift", "SIMA"]) in PAGE
    stored = read_stored_tests().query("test == '15_1%' and measure == 'rms_error'")
    stored = stored.set_index("state")["value"][["x", "y", "z"]]
    np.testing.assert_allclose(record["rms_error", "KF"], stored, rtol=0.02)


def test_nothing_public_is_called_not_public() -> None:
    assert not re.search(r"SIMA's record[^.]*not public|cannot be repeated", PAGE)
    assert "SIMA's record and the observer's velocities are public" in PAGE
