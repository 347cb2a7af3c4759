"""Describes a run of the mating study for a comparison of runs."""

from __future__ import annotations

from functools import partial

from owtsweep.studies.contest import comparing
from owtsweep.studies.mating.contest import CONTEST

#: The keys on which the motions of a record depend, besides its number.
PAIRING = ("seed", "record", "blade", "hub")
describe_run = partial(comparing.describe_run, CONTEST, PAIRING)
