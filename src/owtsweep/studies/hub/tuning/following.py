"""Gives a configuration other sensors, and the tuning that follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from owtsweep.config import Section, changed
from owtsweep.studies.hub.config import TUNED, HubConfig
from owtsweep.studies.hub.sections import SensorConfig
from owtsweep.studies.hub.tuning.rules import DEFAULT, RECORDED, compute_numbers, take_facts

C = TypeVar("C", bound=HubConfig)
S = TypeVar("S", bound=Section)


def follow_sensors(config: C, sensors: SensorConfig) -> C:
    """Return a configuration with other sensors.

    With `tuning=matched`, each number that equals what the rules give for the old sensors becomes
    what they give for the new ones. A number that the user has set, and any other tuning, stays.
    """
    moved = changed(config, sensors=sensors)
    if config.tuning != "matched":
        return moved
    before, after = _compute(config.sensors), _compute(sensors)
    sections = {
        name: _replace(getattr(config, name), before, after, f"{name}.")
        for name in TUNED
        if getattr(config, name) is not None
    }
    return changed(moved, **sections)


def _compute(sensors: SensorConfig) -> dict[str, Any]:
    facts = take_facts(sensors)
    numbers = compute_numbers(facts, sensors.imu.bias_walk)
    return numbers | (RECORDED if facts == DEFAULT else {})


def _replace(section: S, before: Mapping[str, Any], after: Mapping[str, Any], path: str) -> S:
    new: dict[str, Any] = {}
    for name, value in vars(section).items():
        key = f"{path}{name}"
        if isinstance(value, Section):
            new[name] = _replace(value, before, after, f"{key}.")
        elif key in before and value == before[key]:
            new[name] = after[key]
    return changed(section, **new)
