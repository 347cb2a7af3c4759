"""Long records: a few replicates at a time give the bits of all of them together."""

from __future__ import annotations

import weakref
from functools import cached_property

import pandas as pd
import pytest
from tools import plan_blocks, run_blocks

from owtsweep.studies import compose
from owtsweep.studies.hub import records
from owtsweep.studies.hub.worlds import WORLDS

pytestmark = pytest.mark.usefixtures("kernels")

SMALL = [
    "experiment=study", "tuning=paper",
    "grid.natural_period=[4.0]", "grid.amplitude=[0.5,1]", "grid.replicates=5",
    "record.duration=150", "sensors.imu.rate=20", "measures.settling_time=10",
]  # fmt: skip


def _rows(overrides):
    config = compose([*SMALL, *overrides])
    plan, tables = plan_blocks(config), []
    for group in dict.fromkeys(block.group for block in plan):
        of_group = [block for block in plan if block.group == group]
        tables += [table for _, table in run_blocks(config, of_group)]
    rows = pd.concat(tables)
    return rows.sort_values(["scheme", "replicate"], kind="stable", ignore_index=True)


@pytest.fixture
def at_a_time(monkeypatch):
    """How many replicates have their motion in memory, each time that some is made."""
    counts, parts = [], []
    make = records.Records.motion.func

    def motion(self):
        parts.append(weakref.ref(self))
        alive = [part for part in (reference() for reference in parts) if part is not None]
        counts.append(sum(len(part.replicates) for part in alive))
        return make(self)

    watched = cached_property(motion)
    watched.__set_name__(records.Records, "motion")
    monkeypatch.setattr(records.Records, "motion", watched)
    return counts


@pytest.mark.parametrize(
    "overrides",
    [
        ["tuning=paper"],
        ["tuning=paper", "evaluation=direct", "hme.mhe.arrival=mkf"],
        ["tuning=matched"],
        ["engine=reference", "schemes=[MKF]", "record.duration=30"],
    ],
)
@pytest.mark.parametrize("few", [1, 2])
def test_parts_change_no_bit(overrides, few, monkeypatch, at_a_time):
    monkeypatch.setattr(records, "SPAN", 700)
    whole = _rows(overrides)
    assert max(at_a_time) == 5
    at_a_time.clear()
    steps = 20 * (30 if "record.duration=30" in overrides else 150)
    most = few * WORLDS["spectrum"].bytes_per_step * steps + 1
    monkeypatch.setattr(records, "MEMORY_SHARE", most)
    pieces = _rows(overrides)
    assert max(at_a_time) == few
    assert whole.equals(pieces)


def test_one_replicate_runs_however_long_it_is(monkeypatch):
    monkeypatch.setattr(records, "MEMORY_SHARE", 1)
    assert records.count_records_per_block(compose(SMALL)) == 1
