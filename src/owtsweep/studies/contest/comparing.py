"""Describes a run of a contest for a comparison of runs."""

from __future__ import annotations

from collections.abc import Sequence

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.studies.contest.contest import WINDOW, Contest
from owtsweep.studies.contest.origin import list_origin
from owtsweep.studies.contest.tables import list_competing


def describe_run(contest: Contest, pairing: Sequence[str], run: Candidate) -> Aspects:
    """Describe a run by its axes, schemes and criterion, and by what makes its records.

    `pairing` are the keys on which the motion of a record depends, besides its conditions and
    number.
    """
    config = run.config
    return Aspects(
        conditions=contest.find_conditions(config.axes),
        grid={axis: getattr(config.grid, axis) for axis in config.axes},
        schemes=list_competing(config, run.rows),
        criterion=config.criterion,
        window=WINDOW,
        pairing={key: getattr(config, key) for key in pairing},
        origin=list_origin(contest, config),
        score="error",
    )
