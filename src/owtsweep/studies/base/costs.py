"""What a sweep of a study costs, foretold from measured times; rough, as machines differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from owtsweep.sweep.study import Block


class Costs(NamedTuple):
    """Measured computing times of a study on one core, without compilation.

    record: Time of a record, with its measurements and what is known of it, s per sample.
    schemes: Name -> time of a record, s per sample.
    memory: What a process takes, bytes.
    """

    record: float
    schemes: Mapping[str, float]
    memory: float


def predict(
    costs: Costs, blocks: Sequence[Block], samples: int, workers: int
) -> tuple[float, float] | None:
    """Return the computing time of blocks in s, and the memory in bytes, as `Engine.predict`.

    None if a scheme, such as a user's, has no measured time. `samples` are those of a record.
    """
    if any(block.content["scheme"] not in costs.schemes for block in blocks):
        return None
    records = {block.group: count_records(block) for block in blocks}  # shared by its schemes
    each = sum(costs.schemes[block.content["scheme"]] * count_records(block) for block in blocks)
    seconds = samples * (costs.record * sum(records.values()) + each)
    return seconds, costs.memory * (workers + 1)  # the sweep's own process, and its workers'


def count_records(block: Block) -> int:
    """Return how many records a block has."""
    first, stop = block.content["replicates"]
    return int(stop) - int(first)
