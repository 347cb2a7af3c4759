"""What the sensors report of a record: recorded as it is, or simulated in a replicate."""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.sensors import Measurements
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.record import Record

STUDY = "replay"


def replicates(config: ReplayConfig, record: Record) -> int:
    """How many replicates a record has: one where nothing is simulated."""
    return 1 if record.gnss == "recorded" else config.replay.replicates


def measure(config: ReplayConfig, sensors: Sensors, record: Record, replicate: int) -> Measurements:
    """The measurements of one replicate; fixes are NaN where none came.

    All records see the same draws of a replicate, whatever file they come from.
    """

    def named(name: str) -> np.random.Generator:
        return stream(config.seed, STUDY, 0.0, replicate, name)

    if record.gnss == "recorded":
        return Measurements(_given(record.specific_force), record.fixes)
    noise = sensing.noise(config.sensors, sensors, record.steps, named)
    if record.specific_force is not None:  # no noise is added to what a real IMU said
        return Measurements(record.specific_force, record.fixes + noise.fixes)
    force = _given(record.acceleration) @ sensors.rotation  # R' a
    return Measurements(force + noise.specific_force, record.fixes + noise.fixes)


def simulated_bias(config: ReplayConfig, sensors: Sensors, record: Record, replicate: int) -> Array:
    """R b^b of a replicate of a motion, (steps, 2) m/s^2: its noise without all else."""
    from dataclasses import replace

    def named(name: str) -> np.random.Generator:
        return stream(config.seed, STUDY, 0.0, replicate, name)

    quiet = replace(sensors, force_sigma=0.0, gravity=(0.0, 0.0))
    alone = sensing.noise(config.sensors, quiet, record.steps, named)
    return np.asarray(alone.specific_force @ sensors.rotation.T)


def _given(series: Array | None) -> Array:
    if series is None:
        raise TypeError("the record lacks a series that its kind must have")
    return series
