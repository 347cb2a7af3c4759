"""A real scheduler and real worker processes over TCP on the loopback interface."""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from contextlib import nullcontext

import pytest
from fault_tools import content

from owtsweep.config import Compute, changed
from owtsweep.errors import InputError
from owtsweep.sweep import execute
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep

LEVELS = [float(level) for level in range(1, 13)]

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def two_workers(cluster):
    cluster.start_workers(2)
    return cluster


@pytest.fixture
def on(config, two_workers):
    """A configuration on the cluster."""

    def make(**changes):
        compute = Compute(backend="dask", scheduler=two_workers.address)
        return changed(config(**changes), compute=compute)

    return make


@pytest.fixture
def undisturbed(study, config, tmp_path):
    outcome = sweep(study, config(results=tmp_path / "undisturbed", level=LEVELS))
    return content(outcome.run.folder)


@pytest.fixture(params=["shared", "handed back"])
def folder(request, monkeypatch):
    """Workers that see the run folder, and such that do not."""
    if request.param == "handed back":
        # As if the file could not be read there, as on another disk.
        monkeypatch.setattr(execute, "_share_file", lambda _: nullcontext())
    return request.param


def test_the_only_worker_does_the_work(faulty, config, cluster, monkeypatch):
    """No block runs in the coordinator, where a guilty one would kill the sweep."""
    monkeypatch.setattr("owtsweep.sweep.cluster.PATIENCE", 2.0)
    (worker,) = cluster.start_workers(1)
    on_cluster = Compute(backend="dask", scheduler=cluster.address)
    broken = sweep(faulty(**{"A3.0": "kill"}), changed(config(level=LEVELS), compute=on_cluster))
    assert worker.wait(timeout=10) == -signal.SIGKILL
    assert "A3.0" in {failure.label for failure in broken.failed}


def test_same_bits_from_a_cluster(study, on, folder, undisturbed):
    outcome = sweep(study, on(level=LEVELS))
    assert (outcome.computed, outcome.reused, outcome.failed) == (48, 0, [])
    assert content(outcome.run.folder) == undisturbed
    assert not list(outcome.run.folder.glob(".*"))
    again = sweep(study, on(level=LEVELS))
    assert (again.computed, again.reused) == (0, 48)


class Interrupts(Progress):
    def advance(self, cases):
        raise KeyboardInterrupt


class KillsOneWorker(Progress):
    """SIGKILLs a worker process once a third of the cases are there."""

    def __init__(self, process):
        self.process, self.done = process, 0

    def advance(self, cases):
        self.done += cases
        if self.done >= 16 and self.process.poll() is None:
            os.kill(self.process.pid, signal.SIGKILL)
            self.process.wait()


class RestartsTheScheduler(Progress):
    """Kills the scheduler once a third of the cases are there, and starts it and workers again."""

    def __init__(self, cluster):
        self.cluster, self.done = cluster, 0

    def advance(self, cases):
        self.done += cases
        if self.done >= 16 and self.cluster:
            self.cluster.restart_scheduler()
            self.cluster.start_workers(2, wait=False)
            self.cluster = None


def test_restarted_scheduler_loses_nothing(faulty, on, undisturbed, two_workers):
    slow = {f"{scheme}{level}": "slow" for scheme in "AB" for level in LEVELS}
    outcome = sweep(faulty(**slow), on(level=LEVELS), progress=RestartsTheScheduler(two_workers))
    assert outcome.failed == []
    assert outcome.computed + outcome.reused == 48
    assert content(outcome.run.folder) == undisturbed


def test_killed_worker_loses_nothing(faulty, on, folder, undisturbed, two_workers):
    (third,) = two_workers.start_workers(1)
    slow = {f"{scheme}{level}": "slow" for scheme in "AB" for level in LEVELS}
    outcome = sweep(faulty(**slow), on(level=LEVELS), progress=KillsOneWorker(third))
    assert third.poll() == -signal.SIGKILL
    assert outcome.failed == []
    assert outcome.computed + outcome.reused == 48
    assert content(outcome.run.folder) == undisturbed


def test_blocks_that_fail_on_a_cluster_fail_alone(faulty, on, folder):
    outcome = sweep(faulty(**{"A1.0": "raise", "B2.0": "case", "A3.0": "log"}), on(level=LEVELS))
    assert {failure.label: failure.cases for failure in outcome.failed} == {"A1.0": 2, "B2.0": 1}
    log = (outcome.run.folder / "run.log").read_text()
    assert "INFO A3.0: at work" in log
    assert "WARNING A3.0: a user's word" in log
    assert "UserWarning: watch out" in log


def test_dask_is_heard_again_after_a_sweep(study, on, monkeypatch):
    """Its remarks on connections are kept back while they are closed, and no longer."""
    from owtsweep.sweep import cluster

    network = logging.getLogger("distributed.batched")
    silent = logging.getLogger("distributed.silent")
    silent.disabled = True  # by the user
    heard = []

    class Closing(cluster.Client):
        def close(self, *arguments, **options):
            heard.append(network.isEnabledFor(logging.CRITICAL))
            return super().close(*arguments, **options)

    monkeypatch.setattr(cluster, "Client", Closing)
    with pytest.raises(KeyboardInterrupt):
        sweep(study, on(level=LEVELS), progress=Interrupts())
    assert heard[0] is False  # dask may close it again, from its destructor
    assert network.isEnabledFor(logging.CRITICAL)
    assert silent.disabled


def test_workers_limit(faulty, on, tmp_path):
    c = on(level=LEVELS[:4])
    slow = {f"{scheme}{level}": "slow" for scheme in "AB" for level in LEVELS}

    def seconds(workers, name):
        limited = changed(c, compute=changed(c.compute, workers=workers), name=name)
        return sweep(faulty(**slow), limited).seconds

    assert seconds(0, "all") < 0.8 <= seconds(1, "one")  # 8 blocks of 0.1 s


def test_worker_of_another_version_is_refused(study, on, monkeypatch, tmp_path):
    monkeypatch.setattr("owtsweep.sweep.worker.__version__", "9.9")
    with pytest.raises(
        InputError, match=r"tcp://.*the worker has owtsweep_version 0\S* instead of"
    ):
        sweep(study, on())
    assert not (tmp_path / "results").exists()


def test_scheduler_that_does_not_answer_is_refused(study, config, tmp_path, monkeypatch):
    monkeypatch.setattr("owtsweep.sweep.cluster.PATIENCE_AT_START", 0.5)
    c = changed(config(), compute=Compute(backend="dask", scheduler="tcp://127.0.0.1:9"))
    with pytest.raises(InputError, match=r"^compute.scheduler: no scheduler answers at tcp://127"):
        sweep(study, c)
    assert list(tmp_path.iterdir()) == []


def test_study_that_workers_cannot_load_is_refused(config, two_workers, tmp_path, monkeypatch):
    source = "from dummy_study import DummyStudy as D\nclass Mine(D): pass\n"
    (tmp_path / "only_here.py").write_text(source)
    monkeypatch.syspath_prepend(str(tmp_path))
    import only_here

    c = changed(config(), compute=Compute(backend="dask", scheduler=two_workers.address))
    with pytest.raises(InputError, match=r"cannot load the study \(.*only_here"):
        sweep(only_here.Mine(), c)
    assert not (tmp_path / "results").exists()


def test_block_that_kills_every_worker_and_a_cluster_that_dies(
    faulty, on, study, monkeypatch, two_workers, undisturbed
):
    monkeypatch.setattr("owtsweep.sweep.cluster.PATIENCE", 2.0)
    began = time.monotonic()
    broken = sweep(faulty(**{"A3.0": "kill"}), on(level=LEVELS))
    assert time.monotonic() - began < 30
    failed = {failure.label for failure in broken.failed}
    assert "A3.0" in failed
    assert {failure.reason for failure in broken.failed} == {"the cluster has no workers left"}
    assert broken.computed + broken.reused + 2 * len(failed) == 48
    two_workers.start_workers(2)
    mended = sweep(study, on(level=LEVELS))
    assert mended.failed == []
    assert content(mended.run.folder) == undisturbed


def test_guilty_block_is_told_from_the_rest(faulty, on, two_workers, monkeypatch):
    monkeypatch.setattr("owtsweep.sweep.cluster.PATIENCE", 200.0)  # a busy machine starts slowly
    stop = threading.Event()

    def replenish():
        workers = []
        while not stop.wait(0.3):
            workers = [worker for worker in workers if worker.poll() is None]
            if len(workers) < 2:
                workers += two_workers.start_workers(1, wait=False)

    helper = threading.Thread(target=replenish)
    helper.start()
    try:
        broken = sweep(faulty(**{"A3.0": "kill"}), on(level=LEVELS))
    finally:
        stop.set()
        helper.join()
    (failure,) = broken.failed
    assert failure.label == "A3.0"
    assert failure.reason == "KilledWorker: every worker that tried it died"
    assert broken.computed + broken.reused == 46
