"""Prepares a sweep: says what it would do, checks its folder, writes configuration and plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from owtsweep.config import Config, require, typed
from owtsweep.config.stored import read_stored
from owtsweep.io.files import check_writable, remove_stale, unwritable
from owtsweep.io.reading import refuse_links
from owtsweep.sweep import asked
from owtsweep.sweep.keys import run_hash
from owtsweep.sweep.manifest import read_mean_seconds
from owtsweep.sweep.plan import PLAN_FILE, count_cases, is_of_other_version
from owtsweep.sweep.runs import Run, plan_run
from owtsweep.sweep.study import Study, blame

#: Files in the root of a run folder that a sweep writes, besides tables.
FILES = (asked.CONFIG, PLAN_FILE, "manifest.json", "run.log")


def check_folder(run: Run, *, fresh: bool) -> None:
    """Check that a sweep can write its run folder; write nothing.

    Raises InputError if a file or folder is in the way or cannot be written; or if `fresh` is
        False, and the folder holds a run of another version, or the folder that the user named
        another run.
    """
    own = asked.question_folder(run.folder, run.question)
    # else run.log would be appended to its target, and --fresh would delete what lies elsewhere
    refuse_links(run.folder, but=(run.store.cases.name,))
    for folder in (run.folder, run.store.cases, own):
        check_writable(folder)
    for folder, names in ((run.folder, FILES), (own, FILES[:-1])):
        # The tables of the study have no names yet, but every CSV file of a run is a table.
        for path in (*(folder / name for name in names), *folder.glob("*.csv")):
            kind = "folder" if path.is_dir() else "pipe or a device"
            require(
                path.is_file() or not path.exists(),
                f"{path}: this is a {kind} where a file belongs; move it away",
            )
    if not fresh:
        require(
            not is_of_other_version(run.study, run.folder),
            f"{run.folder}: this run was made by another version of owtsweep; to run it again, add "
            "--fresh or delete the folder",
        )
        if run.config.name is not None:
            _require_same_run(run)


def prepare_folder(run: Run, texts: Mapping[str, str], *, fresh: bool) -> None:
    """Check and make a run folder, and write the configuration and the plan there.

    run: the run.
    texts: File name -> content, for config.yaml and plan.json.
    fresh: if True, first delete what the folder holds: shards, tables, figures and all questions.
    Raises InputError as `check_folder`, or if the file system refuses a file.
    """
    check_folder(run, fresh=fresh)
    try:
        run.store.cases.mkdir(parents=True, exist_ok=True)
        if fresh:
            run.store.clear()
            asked.clear(run.folder)
        asked.show(run.folder, type(run.config), run.question, texts, cleared=fresh)
    except OSError as error:
        raise unwritable(run.folder, error) from error
    for folder in (run.folder, run.store.cases, asked.question_folder(run.folder, run.question)):
        remove_stale(folder)


def _require_same_run(run: Run) -> None:
    """Raise InputError if a folder that the user named holds another run.

    The tables of two runs must not be mixed.
    """
    path = run.folder / asked.CONFIG
    if path.is_file():
        plain, _ = read_stored(path)
        # of another study's configuration the keys would not be known
        same_study = plain.get("study") == run.config.study
        model = type(run.config)
        require(
            same_study and run_hash(typed(model, plain)) == run.hash,
            f"name: {run.folder} holds a run with other settings; choose another name, or add "
            "--fresh to replace it",
        )


@dataclass(frozen=True)
class Forecast:
    """What a sweep would do.

    folder: the run folder.
    cases, missing: Number of cases of the plan, and of those that would be computed. Cases in
        damaged shards would be computed.
    workers: Number of workers; 0 means all workers of a cluster, whose number is not known.
    seconds: Expected time, s; None if it is not known.
    basis: where `seconds` comes from: blocks that "earlier" sweeps of the folder have computed, or
        a "rough" rate of the study.
    memory: Expected memory, bytes; None if it is not known.
    most: Most cases, if cells get records until they are decided; `cases` are those of the first
        look. None for a fixed number of records.
    """

    folder: Path
    cases: int
    missing: int
    workers: int
    seconds: float | None
    basis: Literal["earlier", "rough"]
    memory: float | None
    most: int | None = None


def forecast(study: Study, config: Config, *, fresh: bool = False) -> Forecast:
    """Return what a sweep of a configuration would do; nothing is computed or written.

    study, config: the study and its configuration, which must be checked already.
    fresh: whether the sweep would first delete the stored cases.
    Raises InputError if the sweep would refuse to start: the plan is empty, or the folder cannot be
        written or holds another run.
    """
    from joblib import cpu_count

    run = plan_run(study, config)
    plan = run.plan()
    check_folder(run, fresh=fresh)
    store = replace(run.store, read_only=True)
    missing = {
        key: block
        for key, block in plan.items()
        if fresh or block.recompute or store.status(key) != "done"
    }
    compute = config.compute
    workers = compute.workers or (0 if compute.backend == "dask" else cpu_count())
    with blame(study):
        predicted = run.engine.predict(config, list(missing.values()), workers)
    rough, memory = predicted or (None, None)
    mean = read_mean_seconds(run.folder)
    spent = rough if mean is None else mean * len(missing)
    records, most = config.records, None
    if records is not None and records.decides:
        most = count_cases(plan) * records.greatest // records.first
    return Forecast(
        run.folder,
        count_cases(plan),
        count_cases(missing),
        workers,
        # Blocks of one group share expensive inputs, but their mean time covers that.
        spent / workers if spent is not None and workers else None,
        "rough" if mean is None else "earlier",
        memory,
        most,
    )
