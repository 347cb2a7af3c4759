"""What docs/floater.md says, and docs/research of its paper, is what the kept tables say."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from experiments.mehammer2018.published import read_author_record, read_stored_tests

ROOT = Path(__file__).parents[2]
PAGE = " ".join((ROOT / "docs/research/floater_reproduction.md").read_text("utf-8").split())
PLANES = ("delay_bias", "snr_loss")
ANSWER = " ".join((ROOT / "docs/floater.md").read_text("utf-8").split())
KEPT = ROOT / "results" / "reference" / "floater"
CLAIMS = pd.read_csv(KEPT / "fidelity_claims.csv")


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


def read_velocity(plane: str, tuning: str = "matched") -> pd.DataFrame:
    """Return the rms error of velocity over its standard deviation: schemes over cells."""
    table = pd.read_csv(KEPT / f"summary_{plane}.csv").query("measure == 'velocity'")
    table = table[table["tuning"] == tuning]
    return table.pivot_table(index="scheme", columns=plane.split("_"), values="mean")


def test_the_table_of_velocities() -> None:
    errors = read_velocity("delay_bias")
    cells = [(0.0, 0.0), (0.0, 0.01), (0.0, 0.1), (0.0, 0.3), (4.0, 0.0), (16.0, 0.0), (4.0, 0.1)]
    told = re.findall(r"\| ([A-Z_]+)[^|]* ((?:\| \.\d+ ){7})\|", ANSWER)
    assert len(told) == 9
    for scheme, numbers in told:
        found = [float(number) for number in re.findall(r"\.\d+", numbers)]
        np.testing.assert_allclose(found, errors.loc[scheme, cells], atol=0.00051)


def test_which_filter_to_run() -> None:
    for plane in ("delay_bias", "snr_loss"):
        best = pd.read_csv(KEPT / f"best_scheme_{plane}.csv").query("criterion == 'velocity'")
        assert set(best.loc[best["tuning"] == "matched", "best"]) == {"KF_REPAIRED"}
        assert (best["tuning"] == "matched").sum() == 36
    errors = read_velocity("delay_bias")
    percent = (100.0 * errors).round(1)
    at = percent.loc["KF_REPAIRED"]
    assert (at[0.0, 0.0], at[16.0, 0.0], at[0.0, 0.3]) == (2.3, 2.6, 2.3)
    assert "2.3 %, with a delay of 16 samples 2.6 %, with a bias of three tenths" in ANSWER
    printed = percent.loc["KF"].round()
    assert (printed[16.0, 0.0], printed[0.0, 0.3]) == (15.0, 54.0)
    assert "they have 15 % and 54 %, up to 25 times KF_REPAIRED's error" in ANSWER
    ratios = [each.loc["KF"] / each.loc["KF_REPAIRED"] for each in map(read_velocity, PLANES)]
    assert round(max(ratio.max() for ratio in ratios)) == 25
    rolling = read_velocity("roll_snr").xs(20.0, level="snr", axis=1)
    less = (100.0 - 100.0 * rolling.loc["ERROR_STATE"] / rolling.loc["KF_REPAIRED"]).round()
    assert (less[5.0], less[20.0]) == (8.0, 29.0)
    assert "8 % smaller than KF_REPAIRED's at 5 degrees of roll and 29 % at 20" in ANSWER


def test_what_losses_cost() -> None:
    unknown, known = (
        read_velocity("snr_loss", tuning).loc["KF_CONSISTENT"][40.0, 0.1]
        for tuning in ("paper", "matched")
    )
    told = f"has {unknown:.2f} in velocity without knowing of losses, and {known:.3f} with"
    assert told.replace("0.", ".") in ANSWER
