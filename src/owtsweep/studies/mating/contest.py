"""What is the mating study's own in the contest of its schemes: axes, criteria, a run in words."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import WAIT, Contest, tell_single
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.mating.measures import CRITERIA, OTHERS

CONDITIONS = (
    Condition("sigma", "standard deviation of a fix on the blade", "m", scale="log"),
    Condition("outage", "length of an outage on the blade", "s"),
    Condition("hub_sigma", "standard deviation of a fix on the hub", "m", scale="log"),
    Condition("hold", "time together", "s"),
)


def describe_truth(config: MatingConfig) -> str:
    """Return what moves, what counts as together, and the length of the records in words."""
    record, limits = config.record, config.limits
    return (
        f"blade with {' '.join(config.blade) or 'its defaults'}, hub with "
        f"{' '.join(config.hub) or 'its defaults'}; together: within {limits.distance:g} m and "
        f"{limits.speed:g} m/s; {record.duration:g} s at {record.rate:g} Hz"
    )


def describe_sensors(config: MatingConfig) -> str:
    """Return in words the hub's scheme, and the axes that have one value."""
    words = [f"hub estimated by {config.hub_scheme}", *tell_single(CONDITIONS, config)]
    return ", ".join(words)


def describe_hold(config: MatingConfig) -> str:
    hold: Sequence[float] = config.grid.hold
    return f"{hold[0]:g} s" if len(hold) == 1 else "the time on the axis"


CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    measures=(*CRITERIA, WAIT, *OTHERS),
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    pairing=("seed", "record", "blade", "hub"),
)
