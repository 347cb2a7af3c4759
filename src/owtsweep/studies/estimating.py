"""Shows one record of any study: truth, measurements, and what schemes make of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.studies.registry import OURS, compose, get_study
from owtsweep.sweep.study import blame

if TYPE_CHECKING:
    from owtsweep.evaluation.estimate import EstimatedRecord


def estimate(overrides: Sequence[str] = (), replicate: int = 0) -> EstimatedRecord:
    """Make one record of a study, run all schemes of the configuration on it; write nothing.

    Truth and measurements are those of a sweep with the same configuration.

    overrides: Hydra overrides as on the command line, which leave one cell of the grid and one
        tuning, e.g. `["study=blade", "grid.sigma=[0.01]", "grid.outage=[20]", "schemes=[MEKF]"]`.
    replicate: Number of the record, from 0 on.
    Raises InputError if an override is wrong, several cells or tunings are left, or the study has
        no records of its own.
    """
    require(
        isinstance(replicate, int) and replicate >= 0,
        f"replicate: {replicate!r} is no number of a record; give 0, 1, ...",
    )
    config = compose(overrides)
    study = get_study(config.study)
    able = [name for name in OURS if "estimate" in get_study(name).commands]
    require(
        "estimate" in study.commands,
        f"study: {config.study!r} has no records of its own; use one of {', '.join(able)}",
    )
    tunings = list(config.by_tuning())
    require(
        len(tunings) == 1,
        f"tuning: {' and '.join(tunings)} are several tunings; choose, e.g. tuning={tunings[-1]}",
    )
    with blame(study):
        return study.estimate(config, replicate)
