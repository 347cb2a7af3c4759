"""Long records: gains and motion in files give the bits of those in memory."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep import paging
from owtsweep.config import compose
from owtsweep.studies.hub import batch, blocks, chain, feed, records
from owtsweep.studies.hub.gain_rows import GainRows

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
    monkeypatch.setattr(batch, "SPAN", 700)
    monkeypatch.setattr(feed, "SPAN", 700)
    whole = _rows(overrides)
    monkeypatch.setattr(paging, "KEPT_ROWS", 300)
    monkeypatch.setattr(records, "MOST_IN_MEMORY", 1000)
    read = []
    original = paging.Reader.read
    monkeypatch.setattr(
        paging.Reader, "read", lambda self, *args: (read.append(args[:2]), original(self, *args))
    )
    pieces = _rows(overrides)
    assert len(read) > 20
    assert max(stop - first for first, stop, *_ in read) < 2500  # never the whole
    for one, other in zip(whole, pieces, strict=True):
        assert one.equals(other)


def test_rows_of_a_span_are_those_of_the_schedule(monkeypatch):
    config = compose([*SMALL, "tuning=paper"])
    known = records.make_records(config, 4.0, [0])
    scheme = blocks.resolve_all(["HME1"])[0]
    whole = scheme.kernel(known.sensors, config, known.steps)
    monkeypatch.setattr(paging, "KEPT_ROWS", 300)
    rows, cycle = whole.gains.rows, whole.gains.cycle
    weights = batch.weights_of(whole)
    part = GainRows(batch.arrays_of(whole), weights, rows, cycle, 2 * whole.filter.window + 2)
    for first, stop in ((0, 500), (500, 1200), (rows - 40, rows + 300), (rows + 300, rows + 900)):
        arrays, own = part.during(first, stop)
        steps = np.arange(max(first - 2 * whole.filter.window, 0), stop)
        needed = whole.gains.row(steps)
        assert np.array_equal(arrays.filter.C[needed], whole.filter.C[needed])
        assert np.array_equal(arrays.filter.K[needed], whole.filter.K[needed])
        assert np.array_equal(own.precision[needed], weights.precision[needed])
