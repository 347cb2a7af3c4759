"""Says in words what a run of the floater study is: its motion and its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition
from owtsweep.studies.floater.worlds import WORLDS

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig

#: Values of axes of which nothing needs to be said.
USUAL = {"delay": 0.0, "bias": 0.0, "snr": None, "loss": 0.0, "believed": 1.0, "roll": None}
#: Keys of the section `sensors` -> what is said if they are set.
SENSORS = {
    "exact_inertial": "accelerations without noise",
    "bias_drift": "drift {:g} in 100 s",
    "optical_rate": "reports at {:g} Hz",
    "jitter": "jitter {:g} of a sample",
}


def describe_truth(config: FloaterConfig) -> str:
    """Return the motion and the length of the records in words."""
    record, kind = config.record, WORLDS[config.motion.kind].describe(config.motion)
    return f"{kind}; {record.duration:g} s at {record.rate:g} Hz"


def describe_sensors(conditions: Sequence[Condition], config: FloaterConfig) -> str:
    """Return in words what sensors do, the axes that have one value among it."""
    sensors, parts = config.sensors, []
    for condition in conditions:
        if condition.name in config.axes:
            continue
        values = getattr(config.grid, condition.name)
        if values and values[0] != USUAL[condition.name]:
            parts.append(f"{condition.label} {condition.show(values[0])}")
    parts.append("accelerometers fixed to the body" if sensors.frame == "body" else "global frame")
    if sensors.sigma is not None:
        noise = ", ".join(f"{sigma:g}" for sigma in sensors.sigma)
        parts.append(f"noise of positions in m and deg {noise}")
    elif sensors.power == "square":
        parts.append("noise to the mean square")
    given = {key: getattr(sensors, key) for key in SENSORS}
    parts += [words.format(given[key]) for key, words in SENSORS.items() if given[key]]
    if sensors.loss_every is not None:
        parts.append(f"{sensors.loss_length:g} s lost every {sensors.loss_every:g} s")
    parts.append("lost reports arrive as zeros" if sensors.lost_as == "zeros" else "losses missing")
    return ", ".join(parts)
