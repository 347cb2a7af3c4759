"""How many printed numbers agree, in docs/claims.md, is what the kept tables say."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results/reference"
PAGE = (ROOT / "docs/claims.md").read_text("utf-8")


def count(part: pd.DataFrame) -> str:
    assert set(part["agrees"]) <= {"yes", "no"}
    return f"{(part['agrees'] == 'yes').sum()} of {len(part)}"


def read_tables() -> dict[str, pd.DataFrame]:
    fidelity = pd.read_csv(KEPT / "paper/fidelity.csv")
    blade = pd.read_csv(KEPT / "blade/printed.csv")
    return {
        "MSEs of tables 6 to 9": fidelity[fidelity["kind"] == "number"],
        "the EKF's ratio": fidelity[fidelity["item"].str.startswith("EKF velocity / position")],
        "table 3": pd.read_csv(KEPT / "tower/table_3.csv"),
        "rms errors in the author's files": pd.read_csv(KEPT / "floater/stored_tests.csv"),
        "rms errors of section 2.1": blade[blade["scenario"] == "filters"],
        "differences of both systems": blade[blade["scenario"] == "sag and late clock"],
    }


@pytest.mark.parametrize("words", list(read_tables()))
def test_so_many_agree(words: str) -> None:
    (told,) = re.findall(rf"^\|[^|]*\| {words}[^|]*\| \[(\d+ of \d+)\]", PAGE, flags=re.MULTILINE)
    assert told == count(read_tables()[words])


def test_what_is_said_of_table_3_of_simpson() -> None:
    table = read_tables()["table 3"]
    page = " ".join((ROOT / "docs/research/tower_reproduction.md").read_text("utf-8").split())
    assert f"Of its {len(table)} numbers {(table['agrees'] == 'yes').sum()} agree" in page
    alike = table[table["metric"] != "MAE"]
    rotation, dense = alike["state"].str.startswith("theta"), alike["sensors"] == "dense_x_a"
    assert (alike["agrees"][rotation | dense] == "yes").all()
    drifting = alike[~rotation & ~dense]
    assert (drifting["published"] > drifting["mean"])[drifting["agrees"] == "no"].all()
    assert f"{(drifting['agrees'] == 'no').sum()} of {len(drifting)} times" in page
