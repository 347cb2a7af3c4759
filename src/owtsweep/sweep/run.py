"""A sweep from configuration to tables: the plan minus what is stored, then the aggregate."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from owtsweep.config import Config, dump, load, require
from owtsweep.studies.base import OK, Study
from owtsweep.sweep.execute import Executor, Failure
from owtsweep.sweep.files import check_writable, unwritable, write_atomically
from owtsweep.sweep.keys import run_folder, run_hash
from owtsweep.sweep.log import run_log
from owtsweep.sweep.plan import Plan, count_cases, make_plan, tasks
from owtsweep.sweep.progress import Progress, SilentProgress
from owtsweep.sweep.provenance import (
    State,
    finish_manifest,
    package_version,
    shard_metadata,
    start_manifest,
)
from owtsweep.sweep.runs import Results, Run
from owtsweep.sweep.store import Store
from owtsweep.sweep.tables import write_table

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Outcome:
    """What a sweep did.

    Attributes
    ----------
    run
        The run it worked on.
    computed, reused
        Cases computed now, and cases found stored. With those of `failed` they make up the plan.
    failed
        What failed now; it is tried again by the next sweep.
    seconds
        Wall time.
    results
        The rows and tables; None if no case has succeeded.
    """

    run: Run
    computed: int
    reused: int
    failed: list[Failure]
    seconds: float
    results: Results | None = None


def sweep(
    study: Study,
    config: Config,
    *,
    fresh: bool = False,
    progress: Progress | None = None,
    argv: Sequence[str] | None = None,
) -> Outcome:
    """Compute the cases of a configuration that are not stored yet, and aggregate all.

    Parameters
    ----------
    study, config
        What to run; the configuration is checked already.
    fresh
        Delete the stored cases of this run first.
    progress
        Who hears about it; nobody by default.
    argv
        The command line, for the manifest.

    Returns
    -------
    Outcome
        Failed cases are told there and do not raise.

    Raises
    ------
    InputError
        Before anything is written, if the configuration plans nothing or the folder refuses files.
    KeyboardInterrupt
        After the workers were stopped. What is stored stays, and the next sweep goes on from there.
    """
    require(
        config.compute.scheduler is None,
        f"compute.scheduler: {config.compute.scheduler!r} is not known; use null, one machine",
    )
    plan = make_plan(study, config)
    run = Run(run_folder(config), config, study)
    _prepare(run, fresh=fresh)
    with run_log(run.folder):
        return _sweep(run, plan, progress or SilentProgress(), argv)


def _prepare(run: Run, *, fresh: bool) -> None:
    for folder in (run.folder, run.store.cases):
        check_writable(folder)
    for name in ("config.yaml", "manifest.json", "run.log"):
        path = run.folder / name
        require(not path.is_dir(), f"{path}: this is a folder where a file belongs; move it away")
    if run.config.name is not None and not fresh:
        _require_same_run(run)
    try:
        run.store.cases.mkdir(parents=True, exist_ok=True)
        if fresh:
            run.store.clear()
        write_atomically(run.folder / "config.yaml", dump(run.config))
    except OSError as error:
        raise unwritable(run.folder, error) from error


def _require_same_run(run: Run) -> None:
    """A folder named by the user must not mix two runs' tables."""
    path = run.folder / "config.yaml"
    if path.is_file():
        other = run_hash(load(path))
        require(
            other == run.hash,
            f"name: {run.folder} holds a run with other settings; choose another name, or add "
            "--fresh to replace it",
        )


def _sweep(run: Run, plan: Plan, progress: Progress, argv: Sequence[str] | None) -> Outcome:
    began = time.perf_counter()
    executor = _executor(run)
    manifest = start_manifest(
        run.study, run.config, argv=argv, backend=executor.backend, workers=executor.workers
    )
    _write_manifest(run.folder, manifest)
    missing = {key: block for key, block in plan.items() if run.store.status(key) != "done"}
    reused = count_cases(plan) - count_cases(missing)
    computed = 0
    failed: list[Failure] = []
    state: State = "error"
    logger.info("sweep of %d cases, %d of them stored already", count_cases(plan), reused)
    progress.start(count_cases(plan), reused)
    try:
        with closing(executor.run(tasks(missing))) as results:
            for result in results:
                computed += result.computed
                failed += result.failures
                for failure in result.failures:
                    logger.warning("failed: %s: %s", failure.label, failure.reason)
                    progress.fail(failure.label, failure.reason)
                if result.details:
                    logger.info("%s", result.details)
                progress.advance(result.computed + sum(fail.cases for fail in result.failures))
        answer = _aggregate(run)
        state = "incomplete" if failed else "done"
    except KeyboardInterrupt:
        state = "interrupted"
        raise
    finally:
        progress.stop()
        seconds = time.perf_counter() - began
        failures = sum(failure.cases for failure in failed)
        logger.info("%s: %d computed, %d failed in %.1f s", state, computed, failures, seconds)
        _write_manifest(
            run.folder,
            finish_manifest(
                manifest,
                state=state,
                seconds=seconds,
                computed=computed,
                reused=reused,
                failed=failures,
            ),
        )
    return Outcome(run, computed, reused, failed, seconds, answer)


def _executor(run: Run) -> Executor:
    from joblib import cpu_count

    compute = run.config.compute
    backend = compute.backend if compute.backend != "auto" else run.study.backend(run.config)
    versions = {
        **shard_metadata(run.study),
        "owtsweep_version": package_version("owtsweep") or "unknown",
    }
    return Executor(
        study=run.study,
        config=run.config,
        # Absolute: workers outlive a sweep and keep the folder in which they were started.
        store=Store(run.folder.absolute()),
        metadata={name: str(value) for name, value in versions.items()},
        backend=backend,
        # joblib's count heeds the affinity mask and the quota of a container.
        workers=compute.workers or cpu_count(),
    )


def _aggregate(run: Run) -> Results | None:
    """Write the study's tables, if there is anything to put into them."""
    rows, _ = run.stored()
    if rows is None or not (rows["status"] == OK).any():
        logger.warning("no case has succeeded: there are no tables")
        return None
    results = Results(rows, run.study.aggregate(run.config, rows))
    for name, table in results.tables.items():
        write_table(run.folder, name, table)
    return results


def _write_manifest(folder: Path, manifest: dict[str, Any]) -> None:
    write_atomically(folder / "manifest.json", json.dumps(manifest, indent=2) + "\n")
