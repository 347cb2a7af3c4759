"""What is the mating study's own in the contest of its schemes."""

from __future__ import annotations

from owtsweep.studies.contest import Contest
from owtsweep.studies.mating.conditions import CONDITIONS
from owtsweep.studies.mating.measures import CRITERIA, list_measures
from owtsweep.studies.mating.origin import describe_sensors, describe_truth

CONTEST = Contest(CONDITIONS, CRITERIA, list_measures, describe_truth, describe_sensors)
