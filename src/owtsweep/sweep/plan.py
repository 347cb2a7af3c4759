"""Plans the work of a sweep: the blocks of its configuration by key, grouped into tasks."""

from __future__ import annotations

from collections.abc import Mapping

from owtsweep.config import Config, require
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.study import Block, Study

#: Blocks by key, in the study's order.
Plan = dict[str, Block]


def make_plan(study: Study, config: Config) -> Plan:
    """Return all blocks of a configuration by key; of blocks with equal content, keep the first.

    Raises
    ------
    InputError
        If the configuration has no blocks, or the study refuses the configuration.
    """
    plan: Plan = {}
    for block in study.engine(config).plan(config):
        plan.setdefault(block_key(study, block), block)
    require(len(plan) > 0, "grid: it holds no case; give every list a value")
    return plan


def make_tasks(plan: Mapping[str, Block]) -> list[Plan]:
    """Group the blocks of a plan into tasks: one task per `Block.group`, as key -> block.

    Blocks of one group share expensive inputs, so they should run together.
    """
    groups: dict[str, Plan] = {}
    for key, block in plan.items():
        groups.setdefault(block.group, {})[key] = block
    return list(groups.values())


def count_cases(plan: Mapping[str, Block]) -> int:
    """Return the number of cases that the blocks of a plan hold."""
    return sum(block.cases for block in plan.values())
