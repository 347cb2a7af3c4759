"""What is the mating study's own in the contest of its schemes: axes and criteria."""

from __future__ import annotations

from functools import partial

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest
from owtsweep.studies.mating.describe import describe_sensors, describe_truth
from owtsweep.studies.mating.measures import CRITERIA, list_measures

CONDITIONS = (
    Condition("sigma", "standard deviation of a fix on the blade", "m", scale="log"),
    Condition("outage", "length of an outage on the blade", "s"),
    Condition("hub_sigma", "standard deviation of a fix on the hub", "m", scale="log"),
    Condition("hold", "time together", "s"),
)


CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=partial(describe_sensors, CONDITIONS),
    pairing=("seed", "record", "blade", "hub"),
)
