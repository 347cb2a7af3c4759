"""Describes a run of the mating study for a comparison of runs."""

from __future__ import annotations

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.comparison import Candidate
from owtsweep.studies.contest import WINDOW
from owtsweep.studies.contest.origin import list_origin
from owtsweep.studies.contest.tables import list_competing
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.mating.contest import CONTEST

#: The keys on which the motions of a record depend, besides its number.
PAIRING = ("seed", "record", "blade", "hub")


def describe_run(run: Candidate) -> Aspects:
    """Describe a run by its axes, schemes and criterion, and by what makes its records."""
    config: MatingConfig = run.config
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
