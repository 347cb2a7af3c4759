"""`owtsweep runs`: one line for each run in a folder, whatever else lies there."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from owtsweep.cli import BAD_INPUT, DONE, main

QUICK = [
    "study=floater", "experiment=quick", "grid.delay=[1,4]", "grid.bias=[0.03]", "schemes=[KF]",
    "record.duration=60", "grid.replicates=2", "compute=single",
]  # fmt: skip


def list_runs(folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """Return folder -> the rest of its line."""
    capsys.readouterr()
    assert main(["runs", str(folder)]) == DONE
    first, *lines = capsys.readouterr().out.splitlines()
    assert first.split()[0] == "folder"
    return {line.split(maxsplit=1)[0]: line.split(maxsplit=1)[1] for line in lines}


def test_a_folder_of_results(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", *QUICK, f"results={tmp_path}", "name=mine"]) == DONE
    for name in ("half", "broken", "planless", "many"):
        shutil.copytree(tmp_path / "mine", tmp_path / name)
    shards = sorted((tmp_path / "half" / "cases").glob("*.parquet"))
    shards[0].unlink()
    (tmp_path / "broken" / "config.yaml").write_text("study: [")
    (tmp_path / "planless" / "plan.json").write_text(json.dumps({"blocks": [[1]]}))
    (tmp_path / "many").rename(tmp_path / "multirun")
    (tmp_path / "more").mkdir()
    (tmp_path / "multirun").rename(tmp_path / "more" / "inner")
    (tmp_path / "foreign").mkdir()
    (tmp_path / "notes.txt").write_text("nothing")
    lines = list_runs(tmp_path, capsys)
    assert [*lines] == ["broken", "foreign", "half", "mine", "more/inner", "planless"]
    assert lines["mine"].split()[:3] == ["floater", "mine", "matched"]
    assert lines["mine"].endswith("finished")
    assert "of 2" in lines["mine"]
    assert lines["more/inner"] == lines["mine"]
    assert lines["half"].endswith("2 of 4 cases missing")
    assert "damaged: " in lines["broken"]
    assert "damaged: plan.json" in lines["planless"]
    assert lines["foreign"].endswith("no run")


def test_the_committed_runs_are_copies(capsys: pytest.CaptureFixture[str]) -> None:
    lines = list_runs(Path(__file__).parents[2] / "results" / "reference", capsys)
    assert "a copy without its cases" in lines["default"]


def test_code_that_a_run_names_is_not_imported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "config.yaml").write_text(
        "study: their_study\nschemes: [{_target_: no_such_package.Class}]\n"
    )
    assert "their_study" in list_runs(tmp_path, capsys)["theirs"]


def test_no_folder_and_no_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["runs", str(tmp_path / "nowhere")]) == BAD_INPUT
    assert main(["runs", str(tmp_path)]) == DONE
    assert "it holds no run" in capsys.readouterr().out
