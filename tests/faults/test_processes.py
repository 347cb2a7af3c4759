"""Sweeps that are killed, interrupted, or two on one folder: subprocesses and real signals."""

from __future__ import annotations

import os
import random
import signal
import time

import pytest
from fault_tools import child, content, only_run, undisturbed

LEVELS = 20

pytestmark = pytest.mark.faults


def wait_for_shards(results, number, process):
    for _ in range(600):
        if len(list(results.glob("*/cases/part-*.parquet"))) >= number:
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    raise TimeoutError


@pytest.mark.parametrize("backend", ["threading", "loky"])
def test_killed_at_random_moments_and_resumed(tmp_path, backend):
    results = tmp_path / "results"
    moments = random.Random(f"{backend} 4")
    killed = 0
    for _ in range(3):
        process = child(results, backend, 0.1, LEVELS)  # some 2 s of work, on the fastest machine
        time.sleep(moments.uniform(0.5, 1.5))
        killed += process.poll() is None
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
    # And once in the middle for certain, wherever this machine had got to.
    process = child(results, backend, 0.1, LEVELS)
    before = len(list(results.glob("*/cases/part-*.parquet")))
    wait_for_shards(results, min(before + 3, 2 * LEVELS - 5), process)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    last = child(results, backend, 0, LEVELS)
    out, err = last.communicate()
    assert (last.returncode, err) == (0, "")
    assert killed
    assert "were there" in out
    assert content(only_run(results)) == undisturbed(tmp_path / "undisturbed", LEVELS)


@pytest.mark.parametrize("group", [False, True], ids=["process", "group"])
@pytest.mark.parametrize("backend", ["threading", "loky", "dask"])
def test_interrupt_ends_within_two_seconds(tmp_path, backend, group, request):
    """To the process alone, and to its group, as a terminal's Ctrl-C."""
    results = tmp_path / "results"
    scheduler = [request.getfixturevalue("two_workers")] if backend == "dask" else []
    process = child(results, backend, 0.2, LEVELS, *scheduler)
    wait_for_shards(results, 3, process)
    err = interrupt(process, group)
    first, second = err.splitlines()
    # A cluster ends what it has begun: two tasks of two blocks.
    under_way = 8 if backend == "dask" else 4
    stored = 2 * len(list(results.glob("*/cases/part-*.parquet")))
    assert f"of 80 cases are stored in {only_run(results)}/; the same command goes on" in first
    assert stored - under_way <= int(first.split()[2]) <= stored
    assert second.endswith("owtsweep sweep 'grid.note=two words'")


@pytest.mark.parametrize("backend", ["threading", "loky", "dask"])
def test_interrupt_does_not_wait_for_a_long_block(tmp_path, backend, request):
    results = tmp_path / "results"
    scheduler = [request.getfixturevalue("two_workers")] if backend == "dask" else []
    process = child(results, backend, 8, 2, *scheduler)
    log = wait_for(lambda: next(results.glob("*/run.log"), None))
    wait_for(lambda: "8 cases, " in log.read_text())
    time.sleep(2.0)  # all are at their first block by now
    assert "0 of 8 cases are stored" in interrupt(process, False)


def interrupt(process, group):
    began = time.monotonic()
    (os.killpg if group else os.kill)(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=10)
    assert time.monotonic() - began < 2.0
    assert process.returncode == 130
    return err


def wait_for(condition):
    for _ in range(1000):
        if found := condition():
            return found
        time.sleep(0.02)
    raise TimeoutError


@pytest.fixture(scope="module")
def two_workers(cluster):
    cluster.start_workers(2)
    return cluster.address


def test_two_sweeps_on_one_folder_share_the_work(tmp_path):
    results = tmp_path / "results"
    first = child(results, "threading", 0.1, LEVELS)
    wait_for_shards(results, 1, first)
    second = child(results, "threading", 0.1, LEVELS)
    computed = []
    for process in (first, second):
        out, err = process.communicate(timeout=60)
        assert (process.returncode, err) == (0, "")
        computed.append(int(out.split()[0]))
    assert 80 <= sum(computed) <= 96  # at most the tasks under way where they meet, twice
    assert min(computed) > 0
    assert content(only_run(results)) == undisturbed(tmp_path / "undisturbed", LEVELS)


def test_killed_run_is_shown_as_such(tmp_path, capsys, monkeypatch):
    from dummy_study import DummyStudy

    from owtsweep import studies
    from owtsweep.cli import main
    from owtsweep.studies import registry

    results = tmp_path / "results"
    process = child(results, "threading", 0.1, LEVELS)
    wait_for_shards(results, 2, process)
    process.kill()
    process.communicate()
    study = DummyStudy()
    for module in (studies, registry):
        monkeypatch.setattr(module, "get_study", lambda name: study)
    assert main(["show", str(only_run(results))]) == 0
    shown = capsys.readouterr().out
    assert "running, or killed" in shown
    done = int(next(line for line in shown.splitlines() if "finished blocks" in line).split()[-1])
    assert done == 2 * len(list(results.glob("*/cases/part-*.parquet")))
