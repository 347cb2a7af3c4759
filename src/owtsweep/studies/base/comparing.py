"""Describes a run of a contest for a comparison of runs."""

from __future__ import annotations

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.studies.base.contest import WINDOW, Contest
from owtsweep.studies.base.origin import list_origin
from owtsweep.studies.base.tables import list_competing


def describe_run(contest: Contest, run: Candidate) -> Aspects:
    """Describe a run by its axes, schemes and criterion, and by what makes its records."""
    config = run.config
    return Aspects(
        conditions=contest.find_conditions(config),
        grid={axis: getattr(config.grid, axis) for axis in contest.find_axes(config)},
        schemes=list_competing(config, run.rows),
        criterion=config.criterion,
        window=WINDOW,
        pairing={key: getattr(config, key) for key in contest.pairing},
        origin=list_origin(contest, config),
        score="error",
    )
