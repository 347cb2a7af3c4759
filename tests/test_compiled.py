"""What the cache of compiled kernels hangs on, and when compiling is told."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import pytest

from owtsweep import compiled

IMPORTED = "import owtsweep.studies.hub.kernels.chain, owtsweep.studies.hub.kernels.online"
CALLED = """
import numpy as np
from owtsweep.studies.hub.kernels.feeding import keep_rows
keep_rows(0, 0, np.zeros((1, 8)))
"""
NAMED = """
import os, sys, owtsweep.__main__ as process, owtsweep.cli as cli
cli.main = lambda: print(os.environ["OWTSWEEP_COMMAND"], file=sys.stderr) or 0
process.run()
"""


def test_sources_are_all_that_kernels_are_made_of() -> None:
    package = Path(compiled.__file__).parent
    names = {str(path.relative_to(package)) for path in compiled.kernel_sources()}
    assert {
        "compiled.py", "estimation/riccati.py", "estimation/windowing.py",
        "studies/hub/kernels/chain.py", "studies/hub/error_curves/kernels.py",
    } <= names  # fmt: skip
    assert not any("figures" in name or "config" in name for name in names)
    assert len(names) < 50
    assert compiled.cache_directory().name.endswith(compiled.source_hash())


def _errors(code: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == ""
    return done.stderr


def test_compiling_is_told_when_it_happens(tmp_path, monkeypatch) -> None:
    assert _errors(IMPORTED, tmp_path, monkeypatch) == ""
    told = _errors(CALLED, tmp_path, monkeypatch)
    assert told.count("owtsweep: compiling kernels, once") == 1
    assert str(tmp_path) in told
    assert _errors(CALLED, tmp_path, monkeypatch) == ""  # read from the cache


def test_compiling_is_told_once_by_all_processes_of_a_command(tmp_path, monkeypatch) -> None:
    """Workers find out side by side that kernels are missing."""
    say = f"import pathlib, owtsweep.compiled as c; c.announce(pathlib.Path({str(tmp_path)!r}))"
    told = []
    for command in ("1", "1", "2"):
        monkeypatch.setenv(compiled.COMMAND, command)
        told.append(_errors(say, tmp_path, monkeypatch).count("owtsweep: compiling kernels, once"))
    assert told == [1, 0, 1]
    assert [path.name for path in tmp_path.glob("told-*")] == ["told-2"]


def test_a_command_has_one_name_in_all_of_its_processes(tmp_path, monkeypatch) -> None:
    monkeypatch.delenv(compiled.COMMAND, raising=False)
    assert _errors(NAMED, tmp_path, monkeypatch).strip()
    monkeypatch.setenv(compiled.COMMAND, "outer")
    assert _errors(NAMED, tmp_path, monkeypatch) == "outer\n"


def test_on_a_terminal_the_bar_of_another_process_is_erased(tmp_path, monkeypatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for command, stream in (("one", Terminal()), ("two", io.StringIO())):
        monkeypatch.setenv(compiled.COMMAND, command)
        monkeypatch.setattr(sys, "stderr", stream)
        compiled.announce.cache_clear()
        compiled.announce(tmp_path)
        erased = stream.getvalue().startswith("\r\x1b[Kowtsweep: compiling")
        assert erased == (command == "one")


def test_a_folder_that_cannot_be_written_stops_nobody(tmp_path, monkeypatch) -> None:
    occupied = tmp_path / "file"
    occupied.write_text("")
    monkeypatch.setenv("TMPDIR", str(tmp_path))  # where kernels go then: there are none yet
    told = _errors(CALLED, occupied / "kernels", monkeypatch)
    assert "owtsweep-kernels-" in told


def test_kernels_go_with_the_virtual_environment(tmp_path, monkeypatch) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert compiled.cache_directory().parent == tmp_path / "numba-cache"
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)
    assert compiled.cache_directory().parent == tmp_path / "user" / "owtsweep"
