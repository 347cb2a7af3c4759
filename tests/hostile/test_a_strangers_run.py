"""A run folder of another person: reading it executes nothing that it names."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import owtsweep
from owtsweep.cli.program import main
from owtsweep.config import changed
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError
from owtsweep.studies import get_study
from owtsweep.sweep.run import sweep

TINY = (
    "experiment=study", "tuning=paper",
    "grid.natural_period=[4.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=2",
    "record.duration=30", "measures.settling_time=5", "compute.backend=threading", "baselines=[]",
)  # fmt: skip
USERS = "schemes=[MKF,{_target_:user_schemes.HoldLastFix}]"
HARMFUL = ("os.system", "subprocess.Popen", "subprocess.call", "user_schemes.Touching")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, kernels: None) -> Path:
    """A run with a scheme of its author's."""
    here = Path.cwd()
    os.chdir(tmp_path_factory.mktemp("stranger"))
    try:
        return Path.cwd() / owtsweep.run([*TINY, USERS]).folder
    finally:
        os.chdir(here)


@pytest.fixture
def stranger(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it, in a place where their code cannot be imported."""
    monkeypatch.chdir(tmp_path)
    target = tmp_path / "results" / made.name
    subprocess.run(["cp", "-r", made.parent, tmp_path / "results"], check=True)
    for name in ("user_schemes", "hold_last_fix"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "path", [p for p in sys.path if "tests" not in p])
    return target


def rename_target(run: Path, target: str, argument: str) -> None:
    """Give the run a scheme that would run a command, with a plan that fits."""
    config = run / "config.yaml"
    text = config.read_text()
    theirs = "_target_: user_schemes.HoldLastFix"
    assert theirs in text
    text = text.replace(theirs, f"_target_: {target}\n  command: {argument}\n  args: {argument}")
    config.write_text(text)
    plan = json.loads((run / "plan.json").read_text())
    from owtsweep.sweep.plan import digest

    (run / "plan.json").write_text(json.dumps({**plan, "config_digest": digest(text)}))


@pytest.mark.parametrize(
    ("target", "commands"),
    [
        *((target, ("show", "compare")) for target in HARMFUL),
        ("os.system", ("fidelity",)),
        pytest.param("os.system", ("figures",), marks=pytest.mark.faults),
        pytest.param("subprocess.Popen", ("figures", "fidelity"), marks=pytest.mark.faults),
    ],
)
def test_no_reader_executes_what_a_stored_configuration_names(
    stranger, target, commands, monkeypatch
):
    called: list[object] = []
    monkeypatch.setattr(os, "system", called.append)
    monkeypatch.setattr(subprocess, "Popen", lambda *a, **k: called.append(a))
    rename_target(stranger, target, "touch harmed")
    before = set(sys.modules)
    for command in commands:
        others = [str(stranger)] if command == "compare" else []
        assert main([command, str(stranger), *others]) in (0, 2), command
    assert main(["sweep", *TINY, f"name={stranger.name}", "seed=1"]) == 2
    assert called == []
    assert not Path("harmed").exists()
    assert "user_schemes" not in set(sys.modules) - before


def test_a_run_with_its_authors_scheme_is_shown(stranger, capsys):
    assert main(["show", str(stranger)]) == 0
    shown = capsys.readouterr().out
    assert re.search(r"cases missing +0\n", shown)
    run = owtsweep.load(stranger)
    assert set(run.cases().scheme) == {"MKF", "hold"}
    assert list(run.summary().scheme.unique()) == ["MKF", "hold"]


def test_a_scheme_of_a_stored_run_is_not_run_by_another_sweep(stranger):
    config = changed(owtsweep.load(stranger).config, results="elsewhere", name="again")
    with pytest.raises(InputError, match="of the stored run's author, whose code is not run"):
        sweep(get_study("hub"), config)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda plan: [plan], "no plan"),
        (lambda plan: {**plan, "blocks": []}, "no plan"),
        (lambda plan: {**plan, "blocks": [["../../secret", "a", 1, 1]]}, "no plan"),
        (lambda plan: {**plan, "blocks": [[plan["blocks"][0][0], "a", -1, 1]]}, "no plan"),
        (lambda plan: {**plan, "code": []}, "other schemes"),
        (lambda plan: {**plan, "code": [{"name": 3, "linear": True}] * 2}, "other schemes"),
        (
            lambda plan: {**plan, "code": [{**plan["code"][0], "name": 3}] * 2},
            "the name '3' cannot be used",
        ),
        (
            lambda plan: {**plan, "code": [{**plan["code"][0], "batched": "all"}] * 2},
            "batched = 'all' is none of",
        ),
    ],
)
def test_a_plan_is_checked_as_what_it_is(stranger, change, says):
    path = stranger / "plan.json"
    path.write_text(json.dumps(change(json.loads(path.read_text()))))
    with pytest.raises(InputError, match=says):
        owtsweep.load(stranger)


def test_a_stored_interpolation_is_refused(stranger, monkeypatch):
    monkeypatch.setenv("SECRET", "42")
    path = stranger / "config.yaml"
    path.write_text(path.read_text().replace("seed: 2019", "seed: ${oc.env:SECRET}"))
    with pytest.raises(InputError, match=r"interpolation"):
        owtsweep.load(stranger)
    with pytest.raises(InputError, match=r"interpolation"):
        read_stored(path)


@pytest.mark.parametrize("target", ["os.system", "decimal.Decimal", "os.path", "os.environ"])
def test_what_is_no_scheme_class_is_refused_before_it_is_called(target, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    called: list[object] = []
    monkeypatch.setattr(os, "system", called.append)
    with pytest.raises(InputError, match="no class that derives from owtsweep"):
        owtsweep.run([*TINY, f"schemes=[{{_target_: {target}, command: touch harmed}}]"])
    assert called == []
    assert not any(tmp_path.iterdir())
