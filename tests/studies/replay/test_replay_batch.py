"""One bad file of a batch is told with its reason, the rest runs; mended, it alone is computed."""

from __future__ import annotations

import os
from pathlib import Path

import pandas as pd
import pytest
from replay_tools import motion_file

import owtsweep
from owtsweep.cli import main
from owtsweep.studies.replay import files
from owtsweep.studies.replay.blocks import plan
from owtsweep.studies.replay.files import SENSORS, write_sample
from owtsweep.studies.replay.running import configure, execute
from owtsweep.sweep.runs import Run

QUICK = ["schemes=[MKF]", "replay.replicates=1", "measures.settling_time=5"]


@pytest.fixture(autouse=True)
def _three_files_of_which_two_are_bad(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    good = motion_file(Path("good.csv"), duration=20.0).read_text()
    Path("other").mkdir()
    Path("other/good.csv").write_text("time,position_x\n0,1\n")  # the second file of one name
    Path("short.csv").write_text("".join(good.splitlines(keepends=True)[:60]))


FILES = ["other/good.csv", "good.csv", "short.csv"]


def test_bad_files_are_told_and_the_rest_goes_on(capsys, monkeypatch):
    monkeypatch.setattr(Run, "draw", lambda *args, **options: [])
    assert main(["replay", *FILES, *QUICK]) == 1
    out, err = capsys.readouterr()
    (run,) = Path("results").iterdir()
    refused = pd.read_csv(run / "refused.csv").set_index("file")["reason"]
    assert list(refused.index) == ["good", "short"]
    assert (
        refused["good"] == f"{Path('other/good.csv').resolve()}: has 1 rows; at least 32 are needed"
    )
    assert "no longer than measures.settling_time (5 s)" in refused["short"]
    assert list(pd.read_csv(run / "records.csv").file) == ["good-2"]
    assert set(pd.read_csv(run / "errors.csv").file) == {"good-2"}
    assert sorted(path.name for path in (run / "records").iterdir()) == ["good-2"]
    report = (run / "report.md").read_text()
    flat = "".join(out.split())  # a long path is folded
    for label, reason in refused.items():
        assert "".join(f"left out: {reason}".split()) in flat
        assert f"left out: {reason}" in err
        assert f"failed: 2 cases: {reason}" in err
        assert f"- {label}: {reason}" in report
    good = motion_file(Path("good.csv"), duration=20.0)
    Path("other/good.csv").write_text(good.read_text())
    assert main(["replay", *FILES, *QUICK]) == 1
    assert "2 cases computed, 2 were there" in capsys.readouterr().out
    assert list(pd.read_csv(run / "refused.csv").file) == ["short"]
    assert list(pd.read_csv(run / "records.csv").file) == ["good", "good-2"]


def test_a_dry_run_tells_them_too(capsys):
    assert main(["replay", "--dry-run", *FILES, *QUICK]) == 1
    assert "left out: " in capsys.readouterr().err
    assert not Path("results").exists()


def test_a_batch_without_any_usable_file_is_refused(capsys):
    assert main(["replay", "other/good.csv", "short.csv", *QUICK]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("owtsweep: none of the 2 records can be used; the first: ")
    assert len(err.splitlines()) == 1
    assert not Path("results").exists()


def test_from_python_and_a_file_that_may_not_be_read(monkeypatch):
    may, compute = os.access, files._hash
    locked = str(Path("short.csv").resolve())

    def refuse(path, *state):
        if str(path) == locked:
            raise PermissionError(13, "Permission denied")
        return compute(path, *state)

    monkeypatch.setattr(os, "access", lambda path, mode: str(path) != locked and may(path, mode))
    monkeypatch.setattr(files, "_hash", refuse)
    replayed = owtsweep.replay(["good.csv", "short.csv"], QUICK)
    assert replayed.refused().to_dict("records") == [
        {"file": "short", "reason": f"{locked}: cannot be read (Permission denied)"}
    ]
    assert list(replayed.records().file) == ["good"]


def test_keys_of_blocks_do_not_depend_on_other_files():
    both = {
        block.label: block.content for block in plan(configure(["good.csv", "short.csv"], QUICK))
    }
    alone = {block.label: block.content for block in plan(configure(["good.csv"], QUICK))}
    assert alone.items() <= both.items()
    first = execute(configure(["good.csv", "short.csv"], QUICK))
    Path("short.csv").write_text(Path("good.csv").read_text())
    mended = execute(configure(["good.csv", "short.csv"], QUICK))
    assert (mended.computed, mended.reused, mended.failed) == (2, 2, [])
    assert mended.run.folder == first.run.folder


def test_a_contradicting_force_of_a_batch_is_left_out(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_sample(tmp_path)
    table = pd.read_csv(SENSORS, comment="#")[:3000]  # 30 s
    table.to_csv("sound.csv", index=False)
    forces = [name for name in table.columns if name.startswith("acc")]
    table[forces] = -table[forces]
    table.to_csv("turned.csv", index=False)
    words = ["schemes=[MKF]", "measures.settling_time=5"]
    replay = owtsweep.replay(["sound.csv", "turned.csv"], words)
    assert list(replay.refused()["file"]) == ["turned"]
    assert set(replay.advice()["file"]) == {"sound"}
