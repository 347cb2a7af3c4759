"""Plans the work of a sweep: the blocks (units of work) by key, grouped into tasks."""

from __future__ import annotations

from collections.abc import Mapping

from owtsweep.config import Config, require
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.study import Block, Study

#: Blocks by key, in the study's order.
Plan = dict[str, Block]


def make_plan(study: Study, config: Config) -> Plan:
    """Return the plan of a configuration: key -> block, in the study's order.

    A block is the unit of work and storage. Of blocks with equal content, the first is kept.

    Raises
    ------
    InputError
        If the configuration has no blocks, or the study refuses the configuration.
    """
    plan: Plan = {}
    for block in study.engine(config).plan(config):
        plan.setdefault(block_key(study, block), block)
    require(len(plan) > 0, "grid: it holds no case; give every list of the grid a value")
    return plan


def make_tasks(plan: Mapping[str, Block]) -> list[Plan]:
    """Group the blocks (units of work) of a plan into tasks; a task is key -> block.

    There is one task per `Block.group`. Blocks of one group share expensive inputs, so the blocks
    should run together.
    """
    groups: dict[str, Plan] = {}
    for key, block in plan.items():
        groups.setdefault(block.group, {})[key] = block
    return list(groups.values())


def count_cases(plan: Mapping[str, Block]) -> int:
    """Return the number of cases in all blocks (units of work) of a plan."""
    return sum(block.cases for block in plan.values())
