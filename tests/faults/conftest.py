"""Fixtures of the fault tests: the sweep's dummy study, and a dask cluster of real processes."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from dummy_study import DummyConfig, DummyStudy, make_config
from fault_tools import environment


@pytest.fixture
def study() -> DummyStudy:
    return DummyStudy()


@pytest.fixture
def faulty() -> Callable[..., DummyStudy]:
    """A study with faults: `faulty(**{"A1.0": "raise"})`."""
    return lambda **faults: DummyStudy(faults)


@pytest.fixture
def config(tmp_path: Path) -> Callable[..., DummyConfig]:
    """A configuration whose results lie in the test's own folder."""
    return lambda **changes: make_config(changes.pop("results", tmp_path / "results"), **changes)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimpleNamespace]:
    """A scheduler on the loopback interface; `start_workers(n)` gives it worker processes."""
    pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    folder = tmp_path_factory.mktemp("cluster")
    processes: list[subprocess.Popen[bytes]] = []

    def start(*words: str) -> subprocess.Popen[bytes]:
        log = open(folder / f"{len(processes)}.log", "wb")  # noqa: SIM115
        process = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]],
            cwd=folder,
            # Two workers, not four, die of a task before dask gives up: a quicker test.
            env={**environment(), "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"},
            stdout=log,
            stderr=log,
        )
        log.close()
        processes.append(process)
        return process

    def start_scheduler(port: str) -> subprocess.Popen[bytes]:
        return start(
            "dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard", "--no-show",
            "--scheduler-file", str(address_file),
        )  # fmt: skip

    address_file = folder / "scheduler.json"
    start_scheduler("0")
    address = _address(address_file)

    def restart_scheduler() -> None:
        for process in processes:
            process.kill()
            process.wait()
        start_scheduler(address.rpartition(":")[2])

    def start_workers(number: int, wait: bool = True) -> list[subprocess.Popen[bytes]]:
        from distributed import Client

        # Without a nanny the process is the worker itself: killing it is killing the worker.
        words = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
        started = [start("dask_worker", address, *words) for _ in range(number)]
        if not wait:
            return started
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(sum(p.poll() is None for p in processes) - 1, timeout=30)
        return started

    try:
        yield SimpleNamespace(
            address=address, start_workers=start_workers, restart_scheduler=restart_scheduler
        )
    finally:
        for process in processes:
            with contextlib.suppress(OSError):
                process.kill()
            process.wait()


def _address(path: Path) -> str:
    import json

    for _ in range(300):
        with contextlib.suppress(OSError, ValueError, KeyError):
            return str(json.loads(path.read_text())["address"])
        time.sleep(0.1)
    raise TimeoutError("the scheduler did not start")
