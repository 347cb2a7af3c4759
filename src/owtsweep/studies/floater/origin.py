"""Describes the motion and the sensors of a run in words, for titles and messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.floater.conditions import CONDITIONS

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig


def describe_truth(config: FloaterConfig) -> str:
    """Return the motion and the length of the records in words."""
    motion, record = config.motion, config.record
    if motion.kind == "recorded":
        kind = f"motion of {motion.file}"
    else:
        slow = sorted({freedom.resonance.period for freedom in motion.freedoms.values()})
        periods = f"{slow[0]:g} to {slow[-1]:g} s" if len(slow) > 1 else f"{slow[0]:g} s"
        released = "release, natural periods" if motion.kind == "decay" else "resonances of"
        waves = f", waves of {motion.wave_period:g} s" if motion.kind == "synthetic" else ""
        kind = f"{motion.kind} motion, {released} {periods}{waves}"
    return f"{kind}; {record.duration:g} s at {record.rate:g} Hz"


def describe_sensors(config: FloaterConfig) -> str:
    """Return in words what sensors do, the axes that have one value among it."""
    sensors, told = config.sensors, []
    for condition in CONDITIONS:
        if condition.name in config.axes:
            continue
        values = getattr(config.grid, condition.name)
        if values and values[0] != _USUAL[condition.name]:
            told.append(f"{condition.label} {condition.show(values[0])}")
    told.append("accelerometers fixed to the body" if sensors.frame == "body" else "global frame")
    if sensors.sigma is not None:
        told.append("noise of positions in m and deg " + ", ".join(f"{s:g}" for s in sensors.sigma))
    elif sensors.power == "square":
        told.append("noise to the mean square")
    if sensors.exact_inertial:
        told.append("accelerations without noise")
    if sensors.bias_drift:
        told.append(f"drift {sensors.bias_drift:g} in 100 s")
    if sensors.optical_rate is not None:
        told.append(f"reports at {sensors.optical_rate:g} Hz")
    if sensors.jitter:
        told.append(f"jitter {sensors.jitter:g} of a sample")
    if sensors.loss_every is not None:
        told.append(f"{sensors.loss_length:g} s lost every {sensors.loss_every:g} s")
    told.append("lost reports arrive as zeros" if sensors.lost_as == "zeros" else "losses missing")
    return ", ".join(told)


#: Values of axes of which nothing needs to be said.
_USUAL = {"delay": 0.0, "bias": 0.0, "snr": None, "loss": 0.0, "believed": 1.0, "roll": None}
