"""Runs of another version are refused in one line; workers of another version say what differs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from owtsweep.api import load
from owtsweep.cli.program import main
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.sweep.prepare import forecast
from owtsweep.sweep.run import sweep
from owtsweep.sweep.worker import all_versions, tell_other_versions


def raise_version(folder: Path) -> None:
    plan = json.loads((folder / "plan.json").read_text())
    plan["versions"]["numerics_version"] += 1
    (folder / "plan.json").write_text(json.dumps(plan))


def forget_versions(folder: Path) -> None:
    plan = json.loads((folder / "plan.json").read_text())
    del plan["versions"]
    (folder / "plan.json").write_text(json.dumps(plan))


@pytest.mark.parametrize(
    "age", [raise_version, forget_versions, lambda folder: (folder / "plan.json").unlink()]
)
@pytest.mark.parametrize("name", [None, "mine"])
def test_a_run_of_another_version_is_refused_until_it_is_run_again(
    known_study, config, capsys, age, name
):
    asked = changed(config(level=[1.0, 2.0]), name=name)
    folder = sweep(known_study, asked).run.folder
    before = {path.name: path.read_bytes() for path in folder.rglob("*.*") if path.is_file()}
    age(folder)
    for command in ("show", "figures", "fidelity", "compare"):
        others = [str(folder)] if command == "compare" else []
        assert main([command, str(folder), *others]) == 2
        assert capsys.readouterr().err == (
            f"owtsweep: {folder}: this run was made by another version of owtsweep; run its sweep "
            "again\n"
        )
    with pytest.raises(InputError, match="made by another version of owtsweep; run its sweep"):
        load(folder)
    for resume in (sweep, forecast):
        with pytest.raises(InputError, match="run it again, add --fresh or delete the folder"):
            resume(known_study, asked)
    kept = {path.name: path.read_bytes() for path in folder.rglob("*.*") if path.is_file()}
    assert kept == before | {n: data for n, data in kept.items() if n == "plan.json"}
    again = sweep(known_study, asked, fresh=True)
    assert (again.computed, again.reused) == (8, 0)
    assert len(load(folder).cases()) == 8


def test_a_damaged_plan_is_written_anew(study, config):
    folder = sweep(study, config()).run.folder
    (folder / "plan.json").write_text("[")
    assert sweep(study, config()).computed == 0


def test_worker_of_another_version_says_what_differs(study):
    expected = all_versions(study)
    assert tell_other_versions(study, expected) == ""
    told = tell_other_versions(replace(study, numerics_version=2), expected)
    assert told.startswith("the worker has numerics_version 2 instead of 1; ")
    assert "owtsweep_version 0" not in told
