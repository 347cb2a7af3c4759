"""Describes a run of the blade study for a comparison of runs."""

from __future__ import annotations

from functools import partial

from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.contest import comparing

#: The keys on which the motion of a record depends, besides its conditions and number. Those of
#: sensors scale noise, and move or leave out reports, but draw nothing anew.
PAIRING = ("seed", "record", "motion", "boom", "unit")
describe_run = partial(comparing.describe_run, CONTEST, PAIRING)
