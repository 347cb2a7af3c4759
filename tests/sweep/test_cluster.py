"""A small cluster inside this process.

`tests/faults/test_dask.py` does the same, and worse, to processes of their own.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from owtsweep.sweep.execute import _share_file
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep

distributed = pytest.importorskip("distributed", reason="the extra `dask` is not installed")


@pytest.fixture(scope="module")
def address():
    """The scheduler of a cluster of two threads."""
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


def files(outcome):
    paths = [*outcome.run.store.cases.glob("part-*"), *outcome.run.folder.glob("*.csv")]
    return {path.name: path.read_bytes() for path in paths}


def test_a_cluster_gives_the_same_bits_and_tells_what_failed(faulty, config, address, tmp_path):
    faults = {"A1.0": "case", "B2.0": "raise"}
    here = sweep(faulty(**faults), config(results=tmp_path / "here"))
    there = sweep(faulty(**faults), config(backend="dask", scheduler=address))
    assert {failure.label for failure in there.failed} == {"A1.0", "B2.0"}
    assert there.computed == here.computed == 9
    assert files(there) == files(here)
    again = sweep(faulty(), config(backend="dask", scheduler=address))
    assert (again.computed, again.reused, again.failed) == (4, 8, [])


def test_an_interrupt_reaches_through(study, config, address):
    class Interrupts(Progress):
        def advance(self, cases):
            raise KeyboardInterrupt

    c = config(backend="dask", scheduler=address)
    with pytest.raises(KeyboardInterrupt):
        sweep(study, c, progress=Interrupts())
    assert sweep(study, c).failed == []


def test_a_shared_file_may_be_cleaned_up_by_another_sweep(tmp_path):
    with _share_file(tmp_path) as file:
        Path(file).unlink()
    assert not list(tmp_path.iterdir())
