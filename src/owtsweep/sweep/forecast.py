"""Says what a sweep would compute, in what time and memory, without computing or writing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from owtsweep.config import Config
from owtsweep.sweep.keys import question_hash, run_folder
from owtsweep.sweep.plan import count_cases, make_plan
from owtsweep.sweep.prepare import check_folder
from owtsweep.sweep.provenance import read_mean_seconds
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import Predicting, Study, blame


@dataclass(frozen=True)
class Forecast:
    """What a sweep would do.

    Attributes
    ----------
    folder
        The run folder.
    cases, missing
        Number of cases of the plan, and of those that would be computed. Cases in damaged shards
        would be computed.
    workers
        Number of workers; 0 means all workers of a cluster, whose number is not known.
    seconds
        Expected time, s; None if it is not known.
    basis
        Where `seconds` comes from: blocks that "earlier" sweeps of the folder have computed, or a
        "rough" rate of the study.
    memory
        Expected memory, bytes; None if it is not known.
    """

    folder: Path
    cases: int
    missing: int
    workers: int
    seconds: float | None
    basis: Literal["earlier", "rough"]
    memory: float | None


def forecast(study: Study, config: Config, *, fresh: bool = False) -> Forecast:
    """Return what a sweep of a configuration would do; nothing is computed or written.

    Parameters
    ----------
    study, config
        The study and its configuration, which must be checked already.
    fresh
        Whether the sweep would first delete the stored cases.

    Raises
    ------
    InputError
        If the sweep would refuse to start: the plan is empty, or the folder cannot be written or
        holds another run.
    """
    from joblib import cpu_count

    plan = make_plan(study, config)
    run = Run(run_folder(config), config, study, plan, question=question_hash(config))
    check_folder(run, fresh=fresh)
    store = replace(run.store, read_only=True)
    missing = {
        key: block
        for key, block in plan.items()
        if fresh or block.anew or store.status(key) != "done"
    }
    compute = config.compute
    workers = compute.workers or (0 if compute.backend == "dask" else cpu_count())
    predicted = None
    if isinstance(run.engine, Predicting):
        with blame(study):
            predicted = run.engine.predict(config, list(missing.values()), workers)
    rough, memory = predicted or (None, None)
    mean = read_mean_seconds(run.folder)
    spent = rough if mean is None else mean * len(missing)
    return Forecast(
        run.folder,
        count_cases(plan),
        count_cases(missing),
        workers,
        # Blocks of one group share expensive inputs, but their mean time covers that.
        spent / workers if spent is not None and workers else None,
        "rough" if mean is None else "earlier",
        memory,
    )
