"""Says in words what is the same in several configurations: tuning, sensors and truth."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.tuning.rules import take_facts


def list_common_facts(configs: Sequence[HubConfig]) -> tuple[str, ...]:
    """Return the facts that hold for each configuration: tuning, sensors and truth, in this order.

    A fact that differs between the configurations is left out.
    """
    listed = [_list_facts(config) for config in configs]
    return tuple(fact for fact in listed[0] if all(fact in facts for facts in listed))


def _list_facts(config: HubConfig) -> list[str]:
    imu, known = config.sensors.imu, take_facts(config.sensors)
    return [
        f"tuning {config.tuning_name}",
        f"GNSS noise {known.gnss_sigma:g} m",
        f"GNSS rate {known.gnss_rate:g} Hz",
        f"GNSS delay {known.delay:g} s",
        f"IMU noise {known.imu_sigma:g} m/s²",
        f"IMU rate {known.imu_rate:g} Hz",
        f"IMU bias {imu.bias_initial:g} m/s²",
        f"bias walk {imu.bias_walk:g} m/s²/√s",
        f"mean over all records of {config.record.duration:g} s, without the first "
        f"{config.measures.settling_time:g} s",
    ]
