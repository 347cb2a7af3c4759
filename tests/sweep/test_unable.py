"""Cases that their scheme cannot work out: stored, told, not run again, and no failure."""

from __future__ import annotations

import json

import pytest

from owtsweep.cli import main
from owtsweep.cli.running import run_one, setback_lines
from owtsweep.sweep.rows import Setback
from owtsweep.sweep.run import sweep

FAULTS = {"A1.0": "unable", "B2.0": "blind"}
SETBACKS = [Setback("A1.0", "it is unstable", 1), Setback("B2.0", "it is blind", 2)]


def test_such_a_case_is_stored_told_and_not_tried_again(faulty, config):
    first = sweep(faulty(**FAULTS), config())
    assert (first.computed, first.reused, first.failed) == (12, 0, [])
    assert first.unable == SETBACKS
    assert json.loads((first.run.folder / "manifest.json").read_text())["state"] == "done"
    second = sweep(faulty(), config())
    assert (second.computed, second.reused, second.failed) == (0, 12, [])
    assert second.unable == SETBACKS
    cases = second.run.cases()
    assert list(cases["status"]).count("unable") == 3
    assert set(cases[cases["status"] == "unable"]["reason"]) == {"it is unstable", "it is blind"}


def test_it_leaves_its_cell(faulty, config):
    summary = sweep(faulty(**FAULTS), config()).run.summary()
    cells = set(zip(summary["level"], summary["scheme"], strict=True))
    assert (1.0, "A") in cells  # by the replicate that has a number
    assert (2.0, "B") not in cells


def test_a_block_in_which_another_case_failed_is_tried_again(faulty, config):
    torn = sweep(faulty(**{"A1.0": "torn"}), config())
    assert [(failure.reason, failure.cases) for failure in torn.failed] == [("it diverged", 1)]
    assert [(setback.reason, setback.cases) for setback in torn.unable] == [("it is unstable", 1)]
    mended = sweep(faulty(), config())
    assert (mended.computed, mended.reused, mended.failed, mended.unable) == (2, 10, [], [])


def test_a_run_without_any_number_has_no_tables_and_is_no_failure(faulty, config):
    nothing = sweep(faulty(**{"A1.0": "blind", "B1.0": "blind"}), config(level=[1.0]))
    assert (nothing.computed, nothing.failed, nothing.results) == (4, [], {})
    assert [setback.label for setback in nothing.unable] == ["A1.0", "B1.0"]
    assert nothing.run.tables() == {}


@pytest.mark.usefixtures("known_study")
def test_it_is_told_in_one_line_per_reason(known_study, config, capsys):
    known_study.faults = {**FAULTS, "A0.3": "blind"}
    c = config(name="mine")
    assert run_one(c, ["sweep"]) == 0
    out, err = capsys.readouterr()
    told = [line for line in err.splitlines() if line.startswith("unable: ")]
    assert told == [
        "unable: 4 cases: it is blind: B2.0; A0.3",
        "unable: 1 case: it is unstable: A1.0",
    ]
    assert "tries again" not in err
    assert out.splitlines()[-1].startswith("12 cases computed in")
    assert main(["show", f"{c.results}/mine"]) == 0
    shown = capsys.readouterr().out.splitlines()
    place = next(i for i, line in enumerate(shown) if "cases without a number" in line)
    assert [line.split() for line in shown[place + 1 : place + 3]] == [
        ["it", "is", "unstable", "1"],
        ["it", "is", "blind", "4"],
    ]


def test_a_run_without_such_cases_does_not_speak_of_them(known_study, config, capsys):
    c = config(name="mine")
    assert run_one(c, ["sweep"]) == 0
    assert main(["show", f"{c.results}/mine"]) == 0
    out, err = capsys.readouterr()
    assert "unable" not in err
    assert "without a number" not in out
    assert (sweep(known_study, c).run.folder / "figures" / "means.csv").is_file()


def test_lines_of_many_blocks_are_short():
    lines = setback_lines("unable", [Setback(f"block {i}", "it is blind", 2) for i in range(9)])
    assert lines == ["unable: 18 cases: it is blind: block 0; block 1; block 2 and 6 more"]
