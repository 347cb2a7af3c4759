"""Says in words what a run of the blade study is: its motion and its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition
from owtsweep.studies.blade.recorded import REFERENCE

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig

#: Values of axes of which nothing needs to be said.
USUAL = {"outage": 0.0, "offset": 0.0, "lever": 0.0}


def describe_truth(config: BladeConfig) -> str:
    """Return the motion and the length of the records in words."""
    record, swing = config.record, config.motion.freedoms["u"]
    if config.recorded.imu is not None:
        return (
            f"recorded lift, {record.duration:g} s at {record.rate:g} Hz; its reference is "
            f"{REFERENCE} with all fixes"
        )
    parts = []
    if "period" not in config.axes:
        parts.append(f"{(config.grid.period or [swing.period])[0]:g} s")
    if "amplitude" not in config.axes:
        parts.append(f"{(config.grid.amplitude or [swing.sigma])[0]:g} m rms")
    text = f", swing of {' and '.join(parts)}" if parts else ""
    return f"rigid blade on a hook{text}; {record.duration:g} s at {record.rate:g} Hz"


def describe_sensors(conditions: Sequence[Condition], config: BladeConfig) -> str:
    """Return in words what sensors do, the axes that have one value among it."""
    words = [f"inertial unit of grade {config.grade}", f"GNSS at {config.sensors.fix_rate:g} Hz"]
    for condition in conditions:
        if condition.name in config.axes:
            continue
        values = getattr(config.grid, condition.name)
        if values and values[0] != USUAL.get(condition.name):
            words.append(f"{condition.label} {condition.show(values[0])}")
    return ", ".join(words)
