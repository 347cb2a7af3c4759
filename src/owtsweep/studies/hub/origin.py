"""Describes where a run's numbers come from: sensors, truth, tuning, seed and number of records."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.hub.conditions import find_world
from owtsweep.studies.hub.tuning_rules import take_facts

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig, SensorConfig

#: Value of the configuration key `normalise` -> what the amplitude of a motion measures.
MEANING = {"peak": "largest displacement", "rms": "standard deviation"}


def list_sensors(sensors: SensorConfig) -> dict[str, str]:
    """Return name -> value, in words, of each property of the sensors.

    Noise is given as a standard deviation. Tilt, high-pass, scale, outliers, outages and red noise
    are listed only if the sensors have them; those of the paper have none.
    """
    known, imu = take_facts(sensors), sensors.imu
    return {
        "GNSS noise": f"{known.gnss_sigma:g} m",
        "GNSS rate": f"{known.gnss_rate:g} Hz",
        "GNSS delay": f"{known.delay:g} s",
        "IMU noise": f"{known.imu_sigma:g} m/s²",
        "IMU rate": f"{known.imu_rate:g} Hz",
        "IMU bias": f"{imu.bias_initial:g} m/s²",
        "bias walk": f"{imu.bias_walk:g} m/s²/√s",
        **_list_faults(sensors),
    }


def _list_faults(sensors: SensorConfig) -> dict[str, str]:
    """Return name -> value, in words, of what the paper's sensors do not have."""
    told, imu = {}, sensors.imu
    if imu.tilt != 0.0:
        told["IMU tilt"] = (
            "that of the structure" if isinstance(imu.tilt, str) else f"{imu.tilt:g} rad/m"
        )
    if imu.high_pass is not None:
        told["IMU high-pass"] = f"{imu.high_pass:g} Hz"
    if sensors.gnss.scale != 1.0:
        told["GNSS scale"] = f"{sensors.gnss.scale:g}"
    return told | sensors.gnss.list_faults()


def describe_truth(config: HubConfig) -> str:
    """Return the truth of a run in one line: the length of a record, and the sensors' faults.

    The faults are the IMU's bias, and what else the sensors have; see `list_sensors`.
    """
    faults = [f"{name} {value}" for name, value in _list_faults(config.sensors).items()]
    return ", ".join([_describe_records(config), *faults])


def describe_draws(config: HubConfig) -> str:
    """Return in words how many records a cell has, and their seed."""
    if config.engine == "expected":
        return "mean over all records"
    count = config.grid.replicates
    return f"{count} record{'s' * (count != 1)} per cell, seed {config.seed}"


def describe_origin(config: HubConfig) -> str:
    """Return the truth, and the number of records per cell with their seed.

    It is one line. With motion=plant or motion.envelope, a line about the motion comes before it; a
    line about the sensors, if they have what the paper's have not, e.g. a tilt.
    """
    return _tell(config, describe_draws(config))


def describe_in_a_line(config: HubConfig) -> str:
    """Return in one line the tuning, the truth, and the number of records with their seed."""
    return f"Tuning {config.tuning_name}. {' '.join(describe_origin(config).split())}"


def describe_one_record(config: HubConfig) -> str:
    """Return the truth and the seed, for a figure that shows a single record.

    The lines are those of `describe_origin`.
    """
    return _tell(config, f"seed {config.seed}")


def list_origin(config: HubConfig) -> dict[str, str]:
    """Return name -> value, in words, of a run's tuning, sensors, truth, records and seed."""
    told = {
        "tuning": config.tuning_name,
        **list_sensors(config.sensors),
        "record length": f"{config.record.duration:g} s",
    }
    if motion := find_world(config).describe(config):
        told["motion"] = motion
    if config.engine == "expected":
        return told | {"records per cell": "infinitely many (expected value)"}
    return told | {"records per cell": str(config.grid.replicates), "seed": str(config.seed)}


def _tell(config: HubConfig, draws: str) -> str:
    """Return the truth in lines that fit the width of a figure; `draws` ends the last one."""
    faults = [f"{name} {value}" for name, value in _list_faults(config.sensors).items()]
    lines = [motion] if (motion := find_world(config).describe(config)) else []
    lines += [", ".join(faults)] if faults else []
    return "Truth: " + ";\n".join([*lines, f"{_describe_records(config)}; {draws}"])


def _describe_records(config: HubConfig) -> str:
    imu = config.sensors.imu
    return (
        f"records of {config.record.duration:g} s, IMU bias {imu.bias_initial:g} m/s² and walk "
        f"{imu.bias_walk:g} m/s²/√s"
    )
