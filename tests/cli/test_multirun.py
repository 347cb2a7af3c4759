"""Whole studies, one for each combination: what fails is told, what is done is kept."""

import importlib
import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from owtsweep.cli import main

ROOT = Path(__file__).parents[2]
SMALL = [
    "experiment=study", "tuning=paper",
    "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=1",
    "record.duration=25", "schemes=[MKF]", "baselines=[]",
]  # fmt: skip
DELAYS = "sensors.gnss.delay=0.2,0.4"
#: The words of the multirun that several tests begin with.
DONE = [*SMALL[:-2], "baselines=[]", "schemes=[MKF,HME1]", "sensors.gnss.delay=0.4,0.2", "seed=3"]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """A folder in which `sweep -m` has made two runs."""
    folder = tmp_path_factory.mktemp("once")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["sweep", "-m", *DONE]) == 0
    return folder


@pytest.fixture
def done(once):
    """As if `sweep -m` had just made two runs here."""
    shutil.copytree(once, ".", dirs_exist_ok=True)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["seed=range(1,1000000)"], "ask for 999999 runs, and a multirun has at most 10000; give "),
        (["seed=range(999999)", "record.duration=range(25,30,0.001)"], "ask for 5e+09 runs"),
        (["seed=range(1,inf)"], "ask for inf runs"),
        (["seed=range(1,5,0)"], "ask for inf runs"),
        (["seed=" + "1," * 100 + "1", "tuning=" + "paper," * 100 + "paper"],
         "ask for 10201 runs"),
        (["seed=" + "9" * 100_000], "9999: a number has at most 4000 digits"),
        ([""], "'': this is no override; use key=value"),
        (["="], "'=': this is no override; use key=value"),
    ],
)  # fmt: skip
def test_what_is_no_multirun_is_one_line(words, says, capsys, tmp_path):
    assert main(["sweep", "-m", *SMALL, *words]) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert not any(tmp_path.iterdir())


def record():
    (path,) = Path("results").glob("multirun-*/multirun.json")
    return path.parent, json.loads(path.read_text())


def test_the_record_names_the_runs_in_order_with_their_values(done):
    folder, written = record()
    assert written["overrides"] == DONE
    values = [tuple(run["values"].values()) for run in written["runs"]]
    assert values == [("0.4",), ("0.2",)]
    assert {run["folder"] for run in written["runs"]} == {
        path.parent.name for path in folder.glob("*/config.yaml")
    }


@pytest.mark.usefixtures("undrawn")
def test_a_multirun_can_be_compared(done, capsys):
    folder, _ = record()
    assert main(["compare", str(folder)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("In all runs: ")
    assert [line.split()[0] for line in out.splitlines()[1:4]] == [
        "sensors.gnss.delay",
        "0.2",
        "0.4",
    ]
    assert {"comparison.md", "runs.csv", "changed_cells.csv", "best_scheme_maps.png"} <= {
        path.name for path in (folder / "comparison").iterdir()
    }
    assert main(["sweep", "-m", *DONE]) == 0  # the comparison is in nobody's way


@pytest.mark.usefixtures("undrawn")
def test_failed_runs_are_listed_with_the_command_that_retries_just_them(capsys):
    broken = "schemes=[MKF,{_target_:user_schemes.Broken,how:raising}]"
    words = [
        "sweep",
        "-m",
        *SMALL[:-2],
        DELAYS,
        broken,
        "baselines=[]",
        "compute.backend=threading",
    ]
    assert main(words) == 1
    err = capsys.readouterr().err
    listed = [line for line in err.splitlines() if line.startswith("failed: study-")]
    retries = [line for line in err.splitlines() if line.startswith("  retry: ")]
    assert len(listed) == len(retries) == 2
    assert all("case failed" in line for line in listed)
    folder, written = record()
    command = shlex.split(retries[1])
    command = command[command.index("sweep") :]
    assert main(command) == 1
    assert "1 were there" in capsys.readouterr().out  # in the same run folder, not a new one
    assert len(list(folder.glob("*/config.yaml"))) == len(written["runs"]) == 2


@pytest.mark.usefixtures("undrawn")
def test_an_unexpected_exception_in_one_run_leaves_the_others(capsys, monkeypatch):
    command = importlib.import_module("owtsweep.cli.multirun")
    original = command.run_one

    def run_one(config, argv):
        if config.sensors.gnss.delay == 0.2:
            raise ZeroDivisionError("out\nof luck")
        return original(config, argv)

    monkeypatch.setattr(command, "run_one", run_one)
    assert main(["sweep", "-m", *SMALL, DELAYS]) == 1
    err = capsys.readouterr().err
    folder, _ = record()
    assert "ZeroDivisionError: out of luck" in err
    assert err.count("failed: study-") == 1
    assert len(list(folder.glob("*/summary.csv"))) == 1


@pytest.mark.usefixtures("undrawn")
def test_a_refused_run_is_told_apart(done, capsys):
    folder, written = record()
    config = folder / written["runs"][0]["folder"] / "manifest.json"
    config.unlink()
    config.mkdir()
    assert main(["sweep", "-m", *DONE]) == 2
    out, err = capsys.readouterr()
    assert "manifest.json" in err
    assert "0 cases computed, 2 were there" in out


@pytest.mark.usefixtures("undrawn")
def test_an_interrupt_tells_what_is_done(capsys, monkeypatch):
    command = importlib.import_module("owtsweep.cli.multirun")
    original = command.run_one

    def run_one(config, argv):
        if config.sensors.gnss.delay == 0.4:
            raise KeyboardInterrupt
        return original(config, argv)

    monkeypatch.setattr(command, "run_one", run_one)
    assert main(["sweep", "-m", *SMALL, DELAYS]) == 130
    out, err = capsys.readouterr()
    assert "1 of 2 runs done" in out
    assert "not finished" in err
    monkeypatch.setattr(command, "run_one", original)
    assert main(["sweep", "-m", *SMALL, DELAYS]) == 0
    assert "0 cases computed, 1 were there" in capsys.readouterr().out


def launch(launcher, *words):
    """A multirun in a process of its own, whose jobs run in others."""
    package = f"hydra_plugins.hydra_{launcher.split('_')[0]}_launcher"
    pytest.importorskip(package, reason=f"hydra/launcher={launcher} is not installed")
    path = os.pathsep.join([str(ROOT / "tests/helpers"), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, "-m", "owtsweep", "sweep", "-m", *SMALL[:-1], DELAYS, *words,
         f"hydra/launcher={launcher}", "compute.backend=threading"],
        capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip


@pytest.mark.faults
def test_submitit_runs_the_jobs_elsewhere():
    done = launch("submitit_local", "schemes=[MKF]", "hydra.launcher.timeout_min=2")
    assert done.returncode == 0, done.stderr
    folder, written = record()
    assert all((folder / run["folder"] / "summary.csv").is_file() for run in written["runs"])
    assert "2 runs in" in done.stdout


@pytest.mark.faults
def test_joblib_runs_the_jobs_elsewhere_and_their_failures_come_back():
    done = launch("joblib", "schemes=[MKF,{_target_:user_schemes.Broken,how:raising}]")
    assert done.returncode == 1, done.stderr
    folder, written = record()
    assert all((folder / run["folder"] / "summary.csv").is_file() for run in written["runs"])
    assert done.stderr.count("  retry: ") == 2


@pytest.mark.usefixtures("undrawn")
def test_a_results_folder_of_special_characters_holds_the_runs():
    assert main(["sweep", "-m", *SMALL, DELAYS, "results='a[b]{c},d'"]) == 0
    (folder,) = Path("a[b]{c},d").iterdir()
    assert len(list(folder.glob("*/summary.csv"))) == 2
    # Hydra's copy of its settings would name the working folder.
    assert not (folder / "multirun.yaml").exists()
    assert str(Path.cwd()) not in (folder / "multirun.json").read_text()


@pytest.mark.parametrize("text", ["it's", "a\\b", "end\\", "q\\'x", "a[b]{c},d", "a=b c"])
def test_a_quoted_text_is_read_back(text):
    from hydra.core.override_parser.overrides_parser import OverridesParser

    from owtsweep.config.composition import quoted

    assert OverridesParser.create().parse_override(f"x={quoted(text)}").value() == text
