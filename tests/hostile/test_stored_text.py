"""Text files of a stranger's run or multirun: whatever they hold, one line, and no control code."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import owtsweep
from owtsweep.cli.program import FAILED, main
from owtsweep.errors import InputError
from owtsweep.sweep.manifest import read_earlier_seconds, was_running
from owtsweep.sweep.multirun import JobOutcome, read_outcome

TINY = (
    "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=1",
    "record.duration=25", "compute.backend=threading", "schemes=[MKF]",
)  # fmt: skip


def text(content: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(content)


#: What stands where a JSON file belongs.
OTHERS: dict[str, Callable[[Path], object]] = {
    "pipe": os.mkfifo,
    "folder": Path.mkdir,
    "link to itself": lambda path: path.symlink_to(path),
    "link to nothing": lambda path: path.symlink_to("nowhere"),
    "deep": text("[" * 100_000),
    "list": text("[1]"),
    "bytes": lambda path: path.write_bytes(b"\xff\xfe{}"),
    "digits": text('{"runs": ' + "9" * 5000 + "}"),
    "nothing": text(""),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, kernels: None) -> Path:
    results = tmp_path_factory.mktemp("made")
    owtsweep.run([*TINY, "name=run1", f"results={results}"])
    return results


@pytest.fixture
def multirun(made: Path, tmp_path: Path) -> Iterator[Path]:
    """A folder with a run; nothing in it may make a reader wait."""
    shutil.copytree(made, tmp_path / "multirun")
    signal.alarm(20)
    yield tmp_path / "multirun"
    signal.alarm(0)


@pytest.fixture
def run(multirun: Path) -> Path:
    return multirun / "run1"


def told(capsys: pytest.CaptureFixture[str], code: int, *words: object) -> str:
    """What a command says; all of it can be printed."""
    assert main([str(word) for word in words]) == code
    out, err = capsys.readouterr()
    for line in (out + err).split("\n"):
        assert line.isprintable(), repr(line)
    if code:
        assert len([line for line in err.splitlines() if line.startswith("owtsweep: ")]) == 1
    return str(out + err)


@pytest.mark.parametrize("kind", OTHERS)
def test_what_is_no_manifest_is_one_line(run, kind, capsys):
    path = run / "manifest.json"
    path.unlink()
    OTHERS[kind](path)
    assert str(path) in told(capsys, 2, "show", run)
    assert read_earlier_seconds(run) == {}
    assert not was_running(run)


def test_a_manifest_of_anything_is_shown_in_printable_lines(run, capsys):
    deep = '{"a":' * 400 + "[" * 400 + "1" + "]" * 400 + "}" * 400
    (run / "manifest.json").write_text(
        '{"state": "\\ud800\\u001b[2J\\u202e", "\\u001b]0;x": NaN, "argv": ["\\n", 3],'
        f' "blocks": {{"each": {{"x": Infinity, "y": 1}}}}, "deep": {deep}, "{"k" * 9999}": 1}}'
    )
    out = told(capsys, 0, "show", run)
    assert r"\ud800\x1b[2J\u202e" in out
    assert len(out) < 50_000  # a long name is not a wide column
    assert read_earlier_seconds(run) == {"y": 1.0}


@pytest.mark.parametrize("name", ["plan.json", "config.yaml"])
@pytest.mark.parametrize("kind", ["pipe", "folder", "link to itself", "bytes", "deep"])
def test_what_is_no_configuration_or_plan_is_one_line(run, name, kind, capsys):
    (run / name).unlink()
    OTHERS[kind](run / name)
    assert str(run / name) in told(capsys, 2, "show", run)


def test_labels_of_a_plan_are_printable(run):
    plan = json.loads((run / "plan.json").read_text())
    plan["blocks"][0][1] = "\ud800\x1b[2J"
    (run / "plan.json").write_text(json.dumps(plan))
    (block, *_) = owtsweep.load(run).plan().values()
    assert block.label == r"\ud800\x1b[2J"


@pytest.mark.parametrize("kind", OTHERS)
def test_what_is_no_record_of_a_multirun_is_one_line(multirun, kind, capsys):
    OTHERS[kind](multirun / "multirun.json")
    assert "multirun.json" in told(capsys, 2, "compare", multirun)


@pytest.mark.parametrize("folder", ["../../x", "/etc", "..", "", "a/b", 3, None, ["a"]])
def test_a_record_names_folders_beside_it_only(multirun, folder, capsys):
    record = {"runs": [{"folder": folder, "values": {}}]}
    (multirun / "multirun.json").write_text(json.dumps(record))
    assert "no record of a multirun" in told(capsys, 2, "compare", multirun)


@pytest.mark.parametrize("kind", OTHERS)
def test_an_outcome_that_cannot_be_read_is_a_failure(tmp_path, kind):
    OTHERS[kind](tmp_path / "run.json")
    outcome = read_outcome(tmp_path / "run.json")
    assert (outcome.folder, outcome.code) == ("run", FAILED)
    assert outcome.reason.isprintable()
    written = {"folder": "r", "overrides": ["a=1"], "code": 1, "reason": "\x1b"}
    (tmp_path / "r.json").write_text(json.dumps(written))
    assert read_outcome(tmp_path / "r.json") == JobOutcome("r", ["a=1"], 1, r"\x1b")


@pytest.mark.parametrize("name", ["a\0b", "x" * 300, "x/" * 5000, "/dev/null", "\ud800", "no\x1b"])
@pytest.mark.parametrize("command", ["show", "compare"])
def test_what_is_no_folder_is_one_line(name, command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    told(capsys, 2, command, name)


def test_a_folder_without_permission_is_one_line(run, monkeypatch):
    def refuse(self: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "stat", refuse)
    with pytest.raises(InputError, match=r"run1: cannot be read \(Permission denied\)$"):
        owtsweep.load(run)


@pytest.mark.faults
@pytest.mark.parametrize("files", [4, 5, 6])
def test_a_process_out_of_files_says_so(run, files):
    code = f"""
import resource, sys
from owtsweep.cli.program import main
resource.setrlimit(resource.RLIMIT_NOFILE, ({files}, {files}))
sys.exit(main(["figures", {str(run)!r}]))
"""
    words = [sys.executable, "-W", "ignore", "-c", code]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    assert "may not open more files" in lines[-1]
    assert "Traceback" not in done.stderr
