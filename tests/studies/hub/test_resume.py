"""The hub study's life in pieces gives the tables of a run from scratch, bit for bit."""

from __future__ import annotations

import tempfile
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tools import configure

from owtsweep.config import changed
from owtsweep.studies import get_study
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep

pytestmark = pytest.mark.usefixtures("kernels")


class Stops(Progress):
    """Ctrl-C after so many groups."""

    def __init__(self, groups: int) -> None:
        self.left = groups

    def advance(self, cases: int) -> None:
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def some(*pool):
    return st.lists(st.sampled_from(pool), min_size=1, max_size=len(pool), unique=True)


GRIDS = st.fixed_dictionaries(
    {
        "natural_period": some(4.0, 6.5),
        "amplitude": some(0.05, 1.0, 10.0),
        # Blocks of eight: a last one that is short, and one that grows.
        "replicates": st.sampled_from([1, 5, 8, 9, 10]),
    }
)
SCHEMES = some("EKF", "MKF", "HME1", "HME2")
SWEEPS = st.tuples(GRIDS, SCHEMES, st.integers(0, 3), st.integers(1, 2))


def configured(results, grid, schemes, workers=1):
    config = configure("record.duration=10", "measures.settling_time=2")
    return changed(
        config,
        results=str(results),
        grid=changed(config.grid, **grid),
        schemes=schemes,
        compute=changed(config.compute, workers=workers),
    )


@settings(max_examples=10, deadline=None, derandomize=True, database=None)
@given(st.lists(SWEEPS, min_size=1, max_size=3), GRIDS, SCHEMES)
def test_stopped_and_grown_runs_end_as_runs_from_scratch(lives, grid, schemes):
    study = get_study("hub")
    with tempfile.TemporaryDirectory() as folder, patch("os.fsync"):
        lived, scratch = Path(folder) / "lived", Path(folder) / "scratch"
        for earlier, others, groups, workers in lives:
            with suppress(KeyboardInterrupt):
                config = configured(lived, earlier, others, workers)
                sweep(study, config, progress=Stops(groups))
        end = sweep(study, configured(lived, grid, schemes)).run
        fresh = sweep(study, configured(scratch, grid, schemes)).run
        tables = {path.name for path in end.folder.glob("*.csv")}
        assert tables == {"summary.csv", "best_scheme.csv", "ratios.csv"}
        for name in tables:
            assert (end.folder / name).read_bytes() == (fresh.folder / name).read_bytes()
        for path in fresh.store.cases.iterdir():
            assert (end.store.cases / path.name).read_bytes() == path.read_bytes()
