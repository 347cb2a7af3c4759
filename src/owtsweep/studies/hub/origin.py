"""Describes where a run's numbers come from: truth, tuning, seed and number of records."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.hub.plant import describe_plant, is_plant

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig


def describe_truth(config: HubConfig) -> str:
    """Return the truth of a run in words: the length of a record, and the bias of the IMU."""
    imu = config.sensors.imu
    return (
        f"records of {config.record.duration:g} s, IMU bias {imu.bias_initial:g} m/s² and walk "
        f"{imu.bias_walk:g} m/s²/√s"
    )


def describe_draws(config: HubConfig) -> str:
    """Return in words how many records a cell has, and their seed."""
    if config.engine == "expected":
        return "mean over all records"
    count = config.grid.replicates
    return f"{count} record{'s' * (count != 1)} per cell, seed {config.seed}"


def describe_origin(config: HubConfig) -> str:
    """Return the truth, and the number of records per cell with their seed.

    It is one line; with motion=plant or motion.envelope, a line about the motion comes first.
    """
    return f"Truth: {_describe_motion(config)}{describe_truth(config)}; {describe_draws(config)}"


def describe_one_record(config: HubConfig) -> str:
    """Return the truth and the seed, for a figure that shows a single record.

    It is one line; with motion=plant or motion.envelope, a line about the motion comes first.
    """
    return f"Truth: {_describe_motion(config)}{describe_truth(config)}; seed {config.seed}"


def list_origin(config: HubConfig) -> dict[str, str]:
    """Return name -> value, in words, of a run's tuning, sensors, truth, records and seed."""
    gnss, imu = config.sensors.gnss, config.sensors.imu
    told = {
        "tuning": config.tuning_name,
        "GNSS": f"{gnss.sigma:g} m {gnss.rate:g} Hz delay {gnss.delay:g} s",
        "IMU": f"{imu.sigma:g} m/s² {imu.rate:g} Hz",
        "record length": f"{config.record.duration:g} s",
        "IMU bias": f"{imu.bias_initial:g} m/s²",
        "bias walk": f"{imu.bias_walk:g} m/s²/√s",
    }
    if is_plant(config):
        told["motion"] = describe_plant(config)
    if config.engine == "expected":
        return told | {"records per cell": "infinitely many (expected value)"}
    return told | {"records per cell": str(config.grid.replicates), "seed": str(config.seed)}


def _describe_motion(config: HubConfig) -> str:
    if is_plant(config):
        return f"{describe_plant(config)};\n"
    points = config.motion.envelope or []
    told = ", ".join(f"{factor:g} at {time:g} s" for time, factor in points)
    return f"amplitude times {told};\n" if told else ""
