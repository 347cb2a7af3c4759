"""Long records: gains and motion in files give the bits of those in memory."""

from __future__ import annotations

import pytest

from owtsweep import paging
from owtsweep.studies import compose
from owtsweep.studies.hub import batch, blocks, chain, feed, records

pytestmark = pytest.mark.usefixtures("kernels")

SMALL = [
    "grid.natural_period=[4.0]", "grid.amplitude=[0.5]", "grid.replicates=2",
    "record.duration=150", "sensors.imu.rate=20", "measures.settling_time=10",
]  # fmt: skip


def _rows(overrides):
    chain._CHAINS.clear()
    config = compose([*SMALL, *overrides])
    result = [table for _, table in blocks.run(config, blocks.plan(config))]
    chain._CHAINS.clear()
    return result


@pytest.mark.parametrize(
    "overrides",
    [
        ["tuning=paper"],
        ["tuning=paper", "evaluation=direct", "hme.mhe.arrival=mkf"],
        ["tuning=matched"],
    ],
)
def test_files_change_no_bit(overrides, monkeypatch):
    monkeypatch.setattr(feed, "SPAN", 700)
    whole = _rows(overrides)
    monkeypatch.setattr(paging, "KEPT_ROWS", 300)
    monkeypatch.setattr(records, "MOST_IN_MEMORY", 1000)
    released = []
    original = paging.release

    def release(array, first=0, stop=None):
        released.append((array.shape, first, stop))
        original(array, first, stop)

    monkeypatch.setattr(batch, "release", release)
    pieces = _rows(overrides)
    assert len(released) > 20
    assert max(stop - first for _, first, stop in released) < 2500  # never the whole
    for one, other in zip(whole, pieces, strict=True):
        assert one.equals(other)
