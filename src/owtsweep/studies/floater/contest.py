"""What is the floater study's own in the contest of its schemes: axes and criteria."""

from __future__ import annotations

from functools import partial

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest
from owtsweep.studies.floater.describe import describe_sensors, describe_truth
from owtsweep.studies.floater.measures import CRITERIA, list_measures

#: The axes that the grid may have, of which a map shows two.
CONDITIONS = (
    Condition("delay", "delay of the optical system", "samples", plural="delays", enters="sensors"),
    Condition(
        "bias", "bias of accelerometers over standard deviation", plural="biases", enters="sensors"
    ),
    Condition("snr", "signal-to-noise ratio", "dB", enters="sensors"),
    Condition("loss", "share of reports lost", plural="shares of reports lost", enters="sensors"),
    Condition("believed", "believed over true variance of noise", scale="log", enters="knowledge"),
    Condition("roll", "standard deviation of roll", "deg", scale="log"),
)
CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    list_measures=list_measures,
    describe_truth=describe_truth,
    describe_sensors=partial(describe_sensors, CONDITIONS),
    # keys of sensors scale noise, and move or leave out reports, but draw no other numbers
    pairing=("seed", "record", "motion"),
)
