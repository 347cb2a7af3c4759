"""The work of a sweep: the blocks of its configuration by key, grouped into tasks."""

from __future__ import annotations

from collections.abc import Mapping

from owtsweep.config import Config, require
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.study import Block, Study

#: Blocks by key, in the study's order.
Plan = dict[str, Block]


def make_plan(study: Study, config: Config) -> Plan:
    """All blocks of a configuration by key; blocks with equal content are merged.

    Raises
    ------
    InputError
        If there are no blocks, or if the study refuses the configuration.
    """
    plan: Plan = {}
    for block in study.engine(config).plan(config):
        plan.setdefault(block_key(study, block), block)
    require(len(plan) > 0, "grid: it holds no case; give every list a value")
    return plan


def make_tasks(plan: Mapping[str, Block]) -> list[Plan]:
    """One task per group of blocks, because blocks of a group share expensive inputs."""
    groups: dict[str, Plan] = {}
    for key, block in plan.items():
        groups.setdefault(block.group, {})[key] = block
    return list(groups.values())


def count_cases(plan: Mapping[str, Block]) -> int:
    """How many cases the blocks hold."""
    return sum(block.cases for block in plan.values())
