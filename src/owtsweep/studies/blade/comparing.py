"""Describes a run of the blade study for a comparison of runs."""

from __future__ import annotations

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.comparison import Candidate
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.contest import WINDOW
from owtsweep.studies.contest.origin import list_origin
from owtsweep.studies.contest.tables import list_competing

#: The keys on which the motion of a record depends, besides its conditions and number. Those of
#: sensors scale noise, and move or leave out reports, but draw nothing anew.
PAIRING = ("seed", "record", "motion", "boom", "unit")


def describe_run(run: Candidate) -> Aspects:
    """Describe a run by its axes, schemes and criterion, and by what makes its records."""
    config: BladeConfig = run.config
    return Aspects(
        conditions=CONTEST.find_conditions(config.axes),
        grid={axis: getattr(config.grid, axis) for axis in config.axes},
        schemes=list_competing(config, run.rows),
        criterion=config.criterion,
        window=WINDOW,
        pairing={key: getattr(config, key) for key in PAIRING},
        origin=list_origin(CONTEST, config),
        score="error",
    )
