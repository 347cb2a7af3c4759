"""Describes the motions and the sensors of a run in words, for titles and messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.mating.conditions import CONDITIONS

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


def describe_sensors(config: MatingConfig) -> str:
    """Return in words the hub's scheme, and the axes that have one value."""
    told = [f"hub estimated by {config.hub_scheme}"]
    for condition in CONDITIONS:
        if condition.name not in config.axes:
            told.append(
                f"{condition.label} {condition.show(getattr(config.grid, condition.name)[0])}"
            )
    return ", ".join(told)
