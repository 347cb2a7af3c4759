"""Shards that were cut or altered on the disk: set aside, computed again, the same as before."""

from __future__ import annotations

import random

import pytest
from fault_tools import content

from owtsweep.sweep.run import sweep


def cut(data, chance):
    return data[: chance.randrange(len(data))]


def flip(data, chance):
    place = chance.randrange(len(data))
    return data[:place] + bytes([data[place] ^ (1 << chance.randrange(8))]) + data[place + 1 :]


def swap(data, chance):
    """Two of its pages in the wrong order, as after a broken file system's repair."""
    half = len(data) // 2
    return data[half:] + data[:half]


@pytest.mark.parametrize("damage", [cut, flip, swap])
def test_damaged_shards_are_computed_again(study, config, damage):
    chance = random.Random(damage.__name__)
    c = config(level=[float(level) for level in range(1, 17)])
    first = sweep(study, c)
    before = content(first.run.folder)
    for path in first.run.store.cases.glob("part-*.parquet"):
        path.write_bytes(damage(path.read_bytes(), chance))
    again = sweep(study, c)
    assert (again.computed, again.reused, again.failed) == (64, 0, [])
    assert content(again.run.folder) == before
    assert len(list(first.run.store.cases.glob("*.damaged"))) == 32


def test_tables_never_hold_a_damaged_number(study, config):
    """Reading alone, without a sweep: the shard counts as missing."""
    run = sweep(study, config()).run
    path = next(run.store.cases.glob("part-*.parquet"))
    path.write_bytes(flip(path.read_bytes(), random.Random(1)))
    assert len(run.cases()) == 10
