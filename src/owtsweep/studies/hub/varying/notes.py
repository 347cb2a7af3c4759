"""Writes what a reader of errors over a key's values must know: what stays alike, and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import attrgetter

from owtsweep.arrays import Array
from owtsweep.results.conditions import Condition, Value
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.origin import list_sensors
from owtsweep.studies.hub.tuning_rules import RECORDED, RECORDED_FOR
from owtsweep.studies.hub.winners import OTHER_WINDOW


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


BOUND = (
    "The Kalman bound is the least error of an estimator that assumes nothing about the motion; an "
    "estimator that does assume something may have less."
)


def list_notes(
    along: Condition, configs: Mapping[Value, HubConfig], schemes: Sequence[str], mse: Array
) -> tuple[str, ...]:
    """Return sentences on coinciding schemes, HME2's numbers, the bound and the window.

    `mse` are the MSE of `schemes`, shape (schemes, values, motions).
    """
    groups = group_coinciding(schemes, lambda i, j: bool(agree(mse[i], mse[j]).all()))
    told = [f"{' and '.join(group)} have the same errors." for group in groups]
    recorded = [value for value, config in configs.items() if _has_recorded_numbers(config)]
    one_tuning = len({config.tuning_name for config in configs.values()}) == 1
    if RECORDED_FOR in schemes and one_tuning and 0 < len(recorded) < len(configs):
        places = " and ".join(along.show(value) for value in recorded)
        told.append(
            f"At {places}, {RECORDED_FOR} has the numbers that tuning=matched keeps for the "
            "paper's sensors; elsewhere its numbers follow a rule (docs/tuning.md)."
        )
    return (*told, BOUND, OTHER_WINDOW["settled"])


def _has_recorded_numbers(config: HubConfig) -> bool:
    return all(attrgetter(key)(config) == number for key, number in RECORDED.items())
