"""Messages name the program as it can be started from where the user is."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from owtsweep.cli.program import program_here, same_command


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Pretend that the current folder has the environment .venv, whose python runs this."""
    programs = tmp_path / ".venv" / "bin"
    programs.mkdir(parents=True)
    for name in ("python", "owtsweep"):
        (programs / name).touch(mode=0o755)
    monkeypatch.setattr(sys, "executable", str(programs / "python"))
    monkeypatch.setattr(sys, "argv", ["/somewhere/owtsweep/__main__.py"])
    monkeypatch.setenv("PATH", "/usr/bin")
    monkeypatch.chdir(tmp_path)
    return programs


def test_from_make_it_is_the_script_of_the_environment(environment) -> None:
    assert program_here() == ".venv/bin/owtsweep"
    assert same_command(["sweep", "--yes", "name=a b"]) == ".venv/bin/owtsweep sweep 'name=a b'"


def test_in_an_activated_environment_it_is_the_bare_name(environment, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(environment))
    assert program_here() == "owtsweep"


def test_elsewhere_it_is_the_whole_path(environment, monkeypatch) -> None:
    for folder in (environment, environment / "deeper"):
        folder.mkdir(exist_ok=True)
        monkeypatch.chdir(folder)
        assert program_here() == str(environment / "owtsweep")


def test_without_the_script_python_starts_it(environment, monkeypatch) -> None:
    (environment / "owtsweep").unlink()
    assert program_here() == "python -m owtsweep"
    apart = environment.parent / "owtsweep"  # installed elsewhere, and started by its path
    apart.touch(mode=0o755)
    monkeypatch.setattr(sys, "argv", [str(apart)])
    assert program_here() == ".venv/owtsweep"
