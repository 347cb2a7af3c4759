"""Kernels are compiled side by side before the first block, for the types that a study uses."""

from __future__ import annotations

import subprocess
import sys

import pytest

from owtsweep import compiled
from owtsweep.studies.hub import compiling
from owtsweep.studies.hub.compiling import share


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("evaluation", ["superposed", "direct"])
def test_examples_have_the_types_that_a_study_passes(evaluation: str) -> None:
    from numba import typeof

    from owtsweep.estimation import riccati, windowing
    from owtsweep.studies.hub.kernels import feeding, runs

    for name, arguments in share.examples(evaluation).items():
        if name != "keep_lead":  # only records of more than one span call it
            (module,) = [m for m in (riccati, windowing, feeding, runs) if hasattr(m, name)]
            used = getattr(module, name).overloads
            assert tuple(map(typeof, arguments)) in used, name


@pytest.mark.parametrize("processes", [2, 3])
def test_shares_hold_each_part_once_and_are_balanced(processes: int) -> None:
    shares = compiling.make_shares(processes)
    assert sorted(part for some in shares for part in some) == sorted(compiling.PARTS)
    assert shares[0][0] == "prepare"
    assert shares[0][-1] == "whole"  # after the parts that it calls
    seconds = [sum(compiling.PARTS[part] for part in some) for some in shares]
    assert max(seconds) < max(7.6, 1.1 * sum(seconds) / processes)


def test_the_line_counts_down_at_the_pace_of_what_is_done() -> None:
    shares = [["prepare", "whole"], ["span", "finish", "recursion"]]  # 9 s and 7.4 s
    told = compiling.tell_left(shares, {}, 0.0)
    assert told == "compiling kernels, once: 0 of 5 parts, about 9 s left"
    assert "0 of 5 parts, about 6 s left" in compiling.tell_left(shares, {}, 3.0)
    slow = {"span": 2 * 3.7}
    assert "1 of 5 parts, about 11 s left" in compiling.tell_left(shares, slow, 2 * 3.7)
    assert "1 of 5 parts, about 9 s left" in compiling.tell_left(shares, slow, 2 * 4.5)
    # `finish` is overdue: twice its time, and as much again
    assert "1 of 5 parts, about 16 s left" in compiling.tell_left(shares, slow, 4 * 5.0)
    done = dict.fromkeys([*shares[0], *shares[1]], 30.0)
    assert "5 of 5 parts, about 1 s left" in compiling.tell_left(shares, done, 60.0)


@pytest.fixture
def nothing_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))


@pytest.mark.usefixtures("nothing_compiled")
def test_processes_are_started_and_a_pipe_gets_one_line(tmp_path, monkeypatch, capsys) -> None:
    started = []

    def start(evaluation, parts):
        started.append((evaluation, *parts))
        words = [sys.executable, "-c", "print('prepare')"]
        return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)

    monkeypatch.setattr(compiling, "_start", start)
    compiling.compile_kernels("superposed", vectors=True, cores=2)
    assert [first for first, *_ in started] == ["superposed"] * 2
    assert capsys.readouterr().err.count("\n") == 1
    compiling.compile_kernels("superposed", vectors=True, cores=1)
    folder = compiled.usable_directory() / "somewhere"
    folder.mkdir()
    version = f"py3{sys.version_info.minor}"
    (folder / f"runs.superposed-67.{version}.nbi").touch()
    compiling.compile_kernels("superposed", vectors=True, cores=2)
    assert len(started) == 2


@pytest.mark.usefixtures("nothing_compiled")
def test_a_process_that_cannot_be_started_stops_nobody(monkeypatch) -> None:
    def start(*_: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(compiling, "_start", start)
    compiling.compile_kernels("superposed", vectors=True, cores=2)


@pytest.mark.usefixtures("kernels")
def test_a_share_tells_each_part(monkeypatch) -> None:
    monkeypatch.setattr(share.gc, "disable", lambda: None)
    told: list[str] = []
    share.main("superposed", "vectors", "leaving", tell=lambda part, flush: told.append(part))
    assert told == ["leaving"]
