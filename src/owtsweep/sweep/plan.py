"""Plans the work of a sweep: the blocks (units of work) by key, grouped into tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from owtsweep.config import Config, require
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.study import Block, Study

#: Blocks by key, in the study's order.
Plan = dict[str, Block]


def make_plan(study: Study, config: Config) -> Plan:
    """Return all blocks of a configuration by key; of blocks with equal content, keep the first.

    With several tunings, the blocks of each tuning are planned. A block that does not depend on the
    tuning belongs to all of them.

    Raises
    ------
    InputError
        If the configuration has no blocks, or the study refuses the configuration.
    """
    plan: Plan = {}
    for tuning, part in config.by_tuning().items():
        for block in study.engine(part).plan(part):
            key = block_key(study, block)
            plan.setdefault(key, block)
            if tuning and tuning not in plan[key].tunings:
                plan[key] = replace(plan[key], tunings=(*plan[key].tunings, tuning))
    for key, block in plan.items():
        if len(block.tunings) == 1:
            plan[key] = replace(block, label=f"{block.label}, {block.tunings[0]}")
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
