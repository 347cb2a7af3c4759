"""Says in words what is the same in several configurations: tuning, sensors and truth."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.origin import list_sensors


def list_common_facts(configs: Sequence[HubConfig]) -> tuple[str, ...]:
    """Return the facts that hold for each configuration: tuning, sensors and truth, in this order.

    A fact that differs between the configurations is left out.
    """
    listed = [_list_facts(config) for config in configs]
    return tuple(fact for fact in listed[0] if all(fact in facts for facts in listed))


def _list_facts(config: HubConfig) -> list[str]:
    sensors = [f"{name} {value}" for name, value in list_sensors(config.sensors).items()]
    return [
        f"tuning {config.tuning_name}",
        *sensors,
        f"mean over all records of {config.record.duration:g} s, without the first "
        f"{config.measures.settling_time:g} s",
    ]
