"""Kernels are compiled side by side before they are used, for the types that are used."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from owtsweep import compiled
from owtsweep.studies.hub import compiling, estimates
from owtsweep.studies.hub.compiling import share
from owtsweep.studies.hub.compiling.examples import list_examples
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.error_curves.curves import curves
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.on_board import online as online_of
from owtsweep.studies.hub.resolving import resolve_all

USES = [["gains", "superposed"], ["gains", "expected", "superposed"], ["online"]]


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("use", ["superposed", "direct"])
def test_examples_have_the_types_that_records_have(use: str) -> None:
    from owtsweep.studies.hub.kernels import feeding, runs

    require_used(use, feeding.noise, getattr(runs, use))


def test_examples_have_the_types_that_given_series_have() -> None:
    from owtsweep.estimation import riccati, windowing
    from owtsweep.studies import compose
    from owtsweep.studies.hub import sensors
    from owtsweep.studies.hub.error_curves import kernels
    from owtsweep.studies.hub.kernels import online, runs

    config = compose(["tuning=paper"])
    assert isinstance(config, HubConfig)
    known = sensors.sensors(config.sensors)
    scheme: Any
    (scheme,) = resolve_all(["HME1"], config)
    chain: Any = scheme.kernel(Known(known, config), 500)
    assert chain.covariance.shape == (chain.gains.rows, 2, 2)
    require_used("gains", riccati.recursion, windowing.leaving, windowing.covariances)
    estimates.trajectories(chain, known, np.zeros((500, 2)), np.zeros((10, 2)))
    estimates.states(chain, np.zeros((500, 2)), np.zeros((10, 2)))
    require_used("recorded", runs.estimates, runs.states)
    curves(chain, known, steps=500, settled=100, band=(0.2, 0.3))
    require_used("expected", kernels.advance)
    for name in ("EKF", "HME2"):
        online_of(name).update(np.zeros(2), np.zeros(2))
    require_used("online", online.advance)


def require_used(use: str, *kernels: Any) -> None:
    """Require that kernels were called with arguments of the types of the use's examples.

    A kernel that only another kernel calls has no types if that other one was read from the cache.
    """
    from numba import typeof

    for kernel in kernels:
        name = kernel.py_func.__name__
        assert tuple(map(typeof, list_examples(use)[name])) in kernel.overloads, name


@pytest.mark.parametrize("use", compiling.PARTS)
def test_each_part_has_kernels(use: str) -> None:
    from numba import typeof

    some = {name: tuple(map(typeof, given)) for name, given in list_examples(use).items()}
    parts = share.list_parts(use, some)
    assert set(parts) == set(compiling.PARTS[use])
    assert all(parts.values())


@pytest.mark.parametrize("uses", USES)
@pytest.mark.parametrize("processes", [2, 3])
def test_shares_hold_each_part_once_and_are_balanced(uses: list[str], processes: int) -> None:
    shares = compiling.make_shares(uses, processes)
    parts = {f"{use}.{part}": time for use in uses for part, time in compiling.PARTS[use].items()}
    assert sorted(part for some in shares for part in some) == sorted(parts)
    for use in set(uses) - {"gains"}:
        (share_of_use,) = [some for some in shares if f"{use}.whole" in some]
        first = f"{use}.{next(iter(compiling.PARTS[use]))}"
        assert share_of_use.index(first) < share_of_use.index(f"{use}.whole")
        assert all("whole" in part for part in share_of_use[share_of_use.index(f"{use}.whole") :])
    seconds = [sum(parts[part] for part in some) for some in shares]
    longest = max(parts[f"{use}.whole"] + max(compiling.PARTS[use].values()) for use in uses[-1:])
    assert max(seconds) < max(longest, 1.2 * sum(seconds) / processes) + 0.1


def test_the_line_counts_down_at_the_pace_of_what_is_done(monkeypatch) -> None:
    parts = {"prepare": 5.0, "whole": 2.5, "span": 2.2, "finish": 1.3, "recursion": 2.4}
    monkeypatch.setattr(compiling, "PARTS", {"run": parts})
    shares = [["run.prepare", "run.whole"], ["run.span", "run.finish", "run.recursion"]]
    told = compiling.tell_left(shares, {}, 0.0)  # 9 s and 7.4 s
    assert told == "compiling kernels, once: 0 of 5 parts, about 9 s left"
    assert "0 of 5 parts, about 6 s left" in compiling.tell_left(shares, {}, 3.0)
    slow = {"run.span": 2 * 3.7}
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
def test_processes_are_started_once_and_a_pipe_gets_one_line(monkeypatch, capsys) -> None:
    started: list[list[str]] = []

    def start(parts):
        started.append(parts)
        words = [sys.executable, "-c", f"print({parts[0]!r})"]
        return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)

    monkeypatch.setattr(compiling, "_start", start)
    compiling.compile_kernels("gains", vectors=True, cores=1)
    assert not started
    for _ in range(2):  # the second time, all is compiled
        compiling.compile_kernels("gains", vectors=True, cores=2)
    assert len(started) == 2
    compiling.compile_kernels("gains", "online", vectors=True, cores=2)
    assert {part.split(".")[0] for parts in started[2:] for part in parts} == {"online"}
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.usefixtures("nothing_compiled")
def test_a_process_that_cannot_be_started_stops_nobody(monkeypatch) -> None:
    def start(*_: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(compiling, "_start", start)
    compiling.compile_kernels("gains", vectors=True, cores=2)


@pytest.mark.usefixtures("kernels")
def test_a_share_tells_each_part() -> None:
    told: list[str] = []
    share.main("vectors", "gains.leaving", tell=lambda part, flush: told.append(part))
    assert told == ["gains.leaving"]


def test_processes_write_in_turn(tmp_path, monkeypatch) -> None:
    """Two forms of a kernel that are stored at once keep their names in the folder."""
    fcntl = pytest.importorskip("fcntl")
    from numba.core import caching

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(caching.IndexDataCacheFile, "save", lambda self, *what: locked())
    share.write_in_turn()

    def locked() -> None:
        with open(compiled.usable_directory() / "lock") as lock, pytest.raises(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        done.append(True)

    done: list[bool] = []
    caching.IndexDataCacheFile(str(tmp_path), "name", "stamp").save("key", "data")
    assert done
