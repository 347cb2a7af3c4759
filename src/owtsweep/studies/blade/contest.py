"""What is the blade study's own in the contest of its schemes: axes, criteria and words."""

from __future__ import annotations

from owtsweep.studies.base.contest import Contest
from owtsweep.studies.blade.conditions import CONDITIONS
from owtsweep.studies.blade.measures import CRITERIA, list_measures
from owtsweep.studies.blade.origin import describe_sensors, describe_truth

CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors scale noise, and move or leave out reports, but draw nothing anew
    pairing=("seed", "record", "motion", "boom", "unit"),
)
