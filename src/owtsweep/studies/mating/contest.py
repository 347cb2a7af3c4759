"""What is the mating study's own in the contest of its schemes: axes, criteria and words."""

from __future__ import annotations

from owtsweep.studies.base.contest import Contest
from owtsweep.studies.mating.conditions import CONDITIONS
from owtsweep.studies.mating.measures import CRITERIA, list_measures
from owtsweep.studies.mating.origin import describe_sensors, describe_truth

CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    pairing=("seed", "record", "blade", "hub"),
)
