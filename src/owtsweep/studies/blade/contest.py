"""What is the blade study's own in the contest of its schemes: axes and criteria."""

from __future__ import annotations

from functools import partial

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest
from owtsweep.studies.blade.describe import describe_sensors, describe_truth
from owtsweep.studies.blade.measures import CRITERIA, list_measures

#: The axes that the grid may have, of which a map shows two.
CONDITIONS = (
    Condition("sigma", "standard deviation of a GNSS fix", "m", scale="log", enters="sensors"),
    Condition("outage", "length of an outage of GNSS", "s", enters="sensors"),
    Condition("offset", "by what GNSS time stamps come late", "s", enters="sensors"),
    Condition("period", "natural period of the swing", "s"),
    Condition("amplitude", "standard deviation of the swing", "m", scale="log"),
    Condition("lever", "error of the antenna's place", "m", enters="sensors"),
    Condition("heading", "standard deviation of the heading", "deg", scale="log"),
)
CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=partial(describe_sensors, CONDITIONS),
    # keys of sensors scale noise, and move or leave out reports, but draw no other numbers
    pairing=("seed", "record", "motion", "boom", "unit"),
)
