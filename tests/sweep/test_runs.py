"""Runs as read back, their tables and their manifest."""

from __future__ import annotations

import hashlib
import json
import logging
import platform
import subprocess
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from owtsweep.api import load
from owtsweep.errors import InputError
from owtsweep.sweep.keys import run_folder, run_hash
from owtsweep.sweep.manifest import SLOWEST, git_state, summarise_seconds
from owtsweep.sweep.run import sweep


def test_loaded_run_is_the_run(known_study, config):
    outcome = sweep(known_study, config(sigma=0.1 + 0.2, name="mine"))
    run = load(str(outcome.run.folder))
    assert run.config == outcome.run.config
    assert run.hash == run_hash(run.config)
    pd.testing.assert_frame_equal(run.cases(), outcome.run.cases(), check_exact=True)
    pd.testing.assert_frame_equal(
        run.summary(),
        known_study.tables(run.config, run.cases())["summary"],
        check_exact=True,
    )


def test_tables_are_all_tables_by_name(study, faulty, config):
    run = sweep(study, config()).run
    assert list(run.tables()) == ["order", "summary"]
    pd.testing.assert_frame_equal(run.tables()["summary"], run.summary())
    nothing = faulty(**{"A1.0": "raise", "B1.0": "raise"})
    assert sweep(nothing, config(level=[1.0], seed=1)).run.tables() == {}


def test_folder_without_config_is_no_run(tmp_path):
    with pytest.raises(InputError, match=r"holds no config\.yaml"):
        load(tmp_path)


def test_cases_are_sorted_and_missing_ones_are_told(study, config, caplog):
    run = sweep(study, config(level=[2.0, 1.0], schemes=["B", "A"])).run
    cases = run.cases()
    assert list(cases["level"]) == [1.0] * 4 + [2.0] * 4
    assert list(cases["scheme"]) == ["A", "A", "B", "B"] * 2
    assert list(cases.index) == list(range(8))
    next(run.store.cases.glob("part-*")).unlink()
    with caplog.at_level(logging.WARNING):
        assert len(run.cases()) == 6
    assert "of the plan's blocks 1 are missing" in caplog.text


def test_manifest_says_what_made_the_run(faulty, config):
    outcome = sweep(
        faulty(**{"A1.0": "case"}), config(workers=2), argv=["sweep", "grid.replicates=2"]
    )
    text = (outcome.run.folder / "manifest.json").read_text()
    manifest = json.loads(text)
    assert manifest["state"] == "incomplete"
    assert manifest["cases"] == {"computed": 11, "reused": 0, "failed": 1}
    assert manifest["argv"] == ["sweep", "grid.replicates=2"]
    assert manifest["config_hash"] == outcome.run.hash
    assert (manifest["backend"], manifest["workers"]) == ("threading", 2)
    assert (manifest["schema_version"], manifest["numerics_version"]) == (1, 1)
    assert manifest["seed"] == 2019
    assert manifest["python"] == platform.python_version()
    assert manifest["packages"]["numpy"] == np.__version__
    assert pd.Timestamp(manifest["started"]) <= pd.Timestamp(manifest["ended"])
    assert pd.Timestamp(manifest["started"]).utcoffset().total_seconds() == 0.0
    assert manifest["seconds"] > 0.0
    assert manifest["platform"]["cores"] >= 1
    assert str(outcome.run.folder.parent) not in text
    assert f'"{platform.node()}"' not in text


def test_manifest_holds_seconds_per_block_of_all_sweeps(study, config, monkeypatch):
    first = sweep(study, config(level=[1.0]))
    sweep(study, config(level=[2.0]))
    outcome = sweep(study, config(level=[1.0, 2.0]))
    manifest = json.loads((first.run.folder / "manifest.json").read_text())
    assert manifest["blocks"]["count"] == 2  # of the sweep before the blocks of the plan only
    again = sweep(replace(study, pause=0.02), config(level=[1.0, 2.0], schemes=["A", "B", "C"]))
    blocks = json.loads((again.run.folder / "manifest.json").read_text())["blocks"]
    assert set(blocks["each"]) == {"A2.0", "B2.0", "C1.0", "C2.0"}
    assert blocks["each"]["C1.0"] >= 0.02
    assert next(iter(blocks["slowest"])) in ("C1.0", "C2.0")
    assert outcome.computed == 0
    many = summarise_seconds({f"block {i:04}": float(i) for i in range(2000)})
    assert (many["count"], many["each"], len(many["slowest"])) == (2000, {}, SLOWEST)
    assert (many["median"], many["slowest"]["block 1999"]) == (999.5, 1999.0)


def test_manifest_holds_the_configuration_but_no_place(study, config):
    run = sweep(study, config(sigma=0.3)).run
    manifest = json.loads((run.folder / "manifest.json").read_text())
    assert manifest["config"]["sigma"] == 0.3
    assert manifest["config"]["grid"] == {"level": [1.0, 2.0, 0.3]}
    assert "results" not in manifest["config"]
    digest = hashlib.blake2b((run.folder / "config.yaml").read_bytes(), digest_size=16)
    assert manifest["config_digest"] == digest.hexdigest()


def test_manifest_of_an_interrupted_run(faulty, config):
    c = config(name="mine")
    with pytest.raises(KeyboardInterrupt):
        sweep(faulty(**{"A1.0": "interrupt"}), c)
    manifest = json.loads((run_folder(c) / "manifest.json").read_text())
    assert manifest["state"] == "interrupted"
    assert manifest["ended"] is not None


def git(folder, *arguments):
    identity = ["-c", "user.name=t", "-c", "user.email=t@t", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True)


def test_git_state_of_a_checkout_and_of_an_installed_package(tmp_path):
    package = tmp_path / "src" / "thing"
    installed = tmp_path / "venv" / "thing"
    for folder in (package, installed):
        folder.mkdir(parents=True)
        (folder / "__init__.py").write_text("")
    assert git_state(package) is None
    git(tmp_path, "init", "-q")
    assert git_state(package) is None
    git(tmp_path, "add", "src")
    git(tmp_path, "commit", "-qm", "one")
    state = git_state(package)
    assert state["dirty"] is False
    assert len(state["commit"]) == 40
    assert git_state(installed) is None
    (package / "new.py").write_text("")
    assert git_state(package) == {**state, "dirty": True}


def test_git_that_is_not_there_is_no_error(tmp_path, monkeypatch):
    def absent(*arguments, **options):
        raise FileNotFoundError("git")

    monkeypatch.setattr("owtsweep.sweep.manifest.subprocess.run", absent)
    assert git_state(tmp_path) is None


@pytest.mark.parametrize("part", ["sort_columns", "drawings"])
def test_a_study_of_another_package_that_fails_is_named_in_one_line(study, config, part):
    run = sweep(study, config()).run
    setattr(study, part, lambda *args: {}["soil"])
    says = r"^study: 'dummy' of the package dummy_study does not work \(KeyError: 'soil'\); update"
    with pytest.raises(InputError, match=says):
        run.draw()


def test_a_figure_that_raises_leaves_the_others(study, config, caplog):
    run = sweep(study, config()).run
    drawings = study.drawings(run.config, run.tables(), run.cases(), {})
    study.drawings = lambda *args: {"broken": lambda *_: {}["soil"], **drawings}
    assert [path.name for path in run.draw()] == ["means.csv"]
    assert "broken is left out: study: 'dummy' of the package dummy_study" in caplog.text


def test_tables_that_cannot_be_made_lose_no_case(study, config):
    study.tables = lambda *args: {}["soil"]
    outcome = sweep(study, config())
    (failure,) = outcome.failed
    assert "of the package dummy_study does not work (KeyError: 'soil')" in failure.reason
    assert outcome.results == {}
    assert len(outcome.run.cases()) == outcome.computed > 0
