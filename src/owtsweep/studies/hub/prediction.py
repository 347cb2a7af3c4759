"""Predicts roughly what blocks take, from rates that were measured once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.studies.hub.blocks import uses_kernels
from owtsweep.studies.hub.resolving import resolve_all
from owtsweep.studies.hub.sizes import REPLICATES_PER_BLOCK, count_table_bytes
from owtsweep.studies.hub.worlds import find_world

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.study import Block

#: Computing time in s for an IMU step of one record and one scheme, motion and noise included:
#: `results/reference/paper/manifest.json` has 8.98 s for 100 000 steps, 600 records, 4 schemes.
SECONDS_PER_STEP = 3.7e-8
#: Bytes: of the process, per record and step of a worker, and the most of a worker, which runs long
#: records in parts. `benchmarks/measured.json` has the peaks to which these numbers were fitted, to
#: within a fifth up to 2000 s; longer records need less than predicted.
PROCESS, PER_STEP, MOST_OF_WORKER = 300e6, 120, 200e6


def predict(config: HubConfig, blocks: Sequence[Block], workers: int) -> tuple[float, float] | None:
    """Return the computing time of blocks in s, without compilation, and the memory in bytes.

    Return None if a kernel does not run all schemes: the time of step-by-step runs differs by
    orders of magnitude from scheme to scheme.
    """
    for part in config.by_tuning().values():
        schemes = resolve_all(part.schemes, part)
        if not all(uses_kernels(part, scheme) for scheme in schemes):
            return None
    steps = config.record.duration * config.sensors.imu.rate
    records = sum(len(block.content["replicates"]) for block in blocks)
    moved = {block.group: len(block.content["replicates"]) for block in blocks}
    motion = find_world(config).seconds_per_step * steps * sum(moved.values())
    each = min(PER_STEP * steps * REPLICATES_PER_BLOCK, MOST_OF_WORKER)
    tables = sum(count_table_bytes(part) for part in config.by_tuning().values())
    return motion + SECONDS_PER_STEP * steps * records, PROCESS + workers * each + tables
