"""Says in words what a run of the mating study is: what moves, and its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition

if TYPE_CHECKING:
    from owtsweep.studies.mating.config import MatingConfig


def describe_truth(config: MatingConfig) -> str:
    """Return what moves, what counts as together, and the length of the records in words."""
    record, limits = config.record, config.limits
    return (
        f"blade with {' '.join(config.blade) or 'its defaults'}, hub with "
        f"{' '.join(config.hub) or 'its defaults'}; together: within {limits.distance:g} m and "
        f"{limits.speed:g} m/s; {record.duration:g} s at {record.rate:g} Hz"
    )


def describe_sensors(conditions: Sequence[Condition], config: MatingConfig) -> str:
    """Return in words the hub's scheme, and the axes that have one value."""
    lines = [f"hub estimated by {config.hub_scheme}"]
    for condition in conditions:
        if condition.name not in config.axes:
            lines.append(
                f"{condition.label} {condition.show(getattr(config.grid, condition.name)[0])}"
            )
    return ", ".join(lines)


def describe_hold(config: MatingConfig) -> str:
    hold: Sequence[float] = config.grid.hold
    return f"{hold[0]:g} s" if len(hold) == 1 else "the time on the axis"
