"""What is the blade study's own in the contest of its schemes."""

from __future__ import annotations

from owtsweep.studies.blade.conditions import CONDITIONS
from owtsweep.studies.blade.measures import CRITERIA, list_measures
from owtsweep.studies.blade.origin import describe_sensors, describe_truth
from owtsweep.studies.contest import Contest

CONTEST = Contest(CONDITIONS, CRITERIA, list_measures, describe_truth, describe_sensors)
