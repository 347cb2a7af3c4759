"""The README is short, its commands run, and its numbers are those of the kept tables."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

from owtsweep.cli import main
from owtsweep.sweep.runs import Run
from owtsweep.testing import check_scheme

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PROSE = " ".join(README.split())
LINES = README.splitlines()
KEPT = ROOT / "results" / "reference"
#: Fewer schemes, with the same answer.
FEW = ["schemes=[HME1,SKFA]"]
SMALL = "grid.natural_period=[4.0] grid.amplitude=[0.5] record.duration=60 grid.replicates=2"


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder, in which nothing is drawn: drawing takes most of the time."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "mine", raising=False)
    monkeypatch.setattr(Run, "draw", lambda *args, **options: [])
    yield tmp_path
    sys.modules.pop("mine", None)  # other tests have modules of this name


def find_words(line: str) -> list[str]:
    """Return the words of a command line that come after the program's name."""
    words = shlex.split(line, comments=True)
    return words[words.index("owtsweep") + 1 :]


def test_it_is_short_and_its_first_command_stands_high():
    assert len(README.split()) <= 900
    assert [line.startswith("$ owtsweep") for line in LINES[:25]].count(True) == 1
    (picture,) = (number for number, line in enumerate(LINES, 1) if line.startswith("!["))
    assert picture <= LINES.index("<!-- answer of advise: end -->") < 45


def test_the_estimator_runs_beside_the_others(elsewhere, kernels, capsys):
    (code,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert sum(map(bool, code.splitlines())) <= 15
    (elsewhere / "mine.py").write_text(code)
    import mine

    check_scheme(mine.LastFix())
    (line,) = (line for line in LINES if line.startswith("PYTHONPATH"))
    assert main([*find_words(line), *SMALL.split()]) == 0
    assert "LastFix is best in no cell" in " ".join(capsys.readouterr().out.split())


def test_the_commands_of_the_record_say_what_is_quoted(elsewhere, kernels, capsys):
    commands = [find_words(line) for line in LINES if line.startswith("owtsweep replay")]
    assert len(commands) == 3
    for words in commands:
        assert main([*words, *(FEW if words[1:] == ["sample_sensors.csv"] else [])]) == 0
    (quoted,) = re.findall(r"It ends.*?```\n(.*?)```", README, flags=re.DOTALL)
    assert capsys.readouterr().out.endswith(quoted)


def test_how_many_chances_are_missed():
    ((hme1, low, high),) = re.findall(r"HME1 on the hub misses (\d+) %.*SKFA (\d+)-(\d+) %", README)
    for name, told in (("sigma_hub", (hme1, hme1)), ("sigma_hub_skfa", (low, high))):
        table = pd.read_csv(KEPT / f"mating/summary_{name}.csv").query(
            "measure == 'missed' and sigma == 0.01 and hub_sigma == 0.01"
        )
        filters = table["scheme"].isin(["UKF", "MEKF_HEADING", "PENDULUM"])
        missed = 100.0 * table.loc[filters, "mean"]
        assert [missed.min(), missed.max()] == pytest.approx([float(n) for n in told], abs=0.5)


def test_how_many_statements_are_reproduced():
    ((total, held),) = re.findall(r"of the (\d+) statements in the hub's paper (\d+) do", PROSE)
    claims = pd.read_csv(KEPT / "paper/fidelity.csv").query("kind == 'statement'")
    assert len(claims) == int(total)
    assert (claims["agrees"] == "reproduced").sum() == int(held)


def test_hme1_is_best_above_a_third_of_a_metre():
    assert "HME1 above 0.3 m, else MKF or zero; mostly SKFA is better." in PROSE
    best = pd.read_csv(KEPT / "default/best_scheme.csv").query("criterion == 'position'")
    assert set(best.loc[best["amplitude"] > 0.3, "best"]) == {"HME1"}
    assert set(best.loc[best["amplitude"] < 0.3, "best"]) == {"MKF"}
    assert best.loc[best["amplitude"] < 0.2, "baseline_wins"].all()


def test_the_first_command_prints_what_is_quoted(elsewhere, kernels, capsys):
    (line,) = (line for line in LINES if line.startswith("$ owtsweep"))
    (quoted,) = re.findall(r"answer of advise: begin -->\n```\n(.*?)```\n<!--", README, re.DOTALL)
    assert main(find_words(line)) == 0
    assert capsys.readouterr().out == quoted
