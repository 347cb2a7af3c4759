"""Runs a sweep: computes the blocks (units of work) that are not stored, then writes the tables."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from importlib.util import find_spec

from owtsweep.config import Config, Plain, dump, require
from owtsweep.errors import InputError
from owtsweep.io.tables import dump_tables
from owtsweep.sweep import asked
from owtsweep.sweep.execute import BACKENDS, Executor
from owtsweep.sweep.gather import Results, join_tables
from owtsweep.sweep.log import repeat, run_log
from owtsweep.sweep.manifest import (
    MANIFEST,
    finish_manifest,
    read_earlier_seconds,
    start_manifest,
    was_running,
)  # fmt: skip
from owtsweep.sweep.plan import PLAN_FILE, Plan, count_cases, dump_plan, make_tasks, plan_look
from owtsweep.sweep.prepare import prepare_folder
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.rows import Setback
from owtsweep.sweep.runs import Run, plan_run
from owtsweep.sweep.study import UNABLE, Study, blame
from owtsweep.sweep.worker import TaskResult, Work, all_versions, one_line

logger = logging.getLogger(__name__)


@dataclass
class Outcome:
    """The outcome of a sweep, which fills it in.

    run: the run to which the sweep belongs.
    computed, reused: Number of cases that this sweep computed, and of cases that were stored
        before. Together with the cases of `failed` they are the whole plan.
    failed: Cases that failed in this sweep; the next sweep tries them again.
    seconds: Wall time, s.
    results: the results of the run by tuning (`Run.make_results`); empty if no case has succeeded
        or no tables could be made.
    unable: Cases, computed or stored before, that have no number because their scheme cannot
        compute them.
    """

    run: Run
    computed: int = 0
    reused: int = 0
    failed: list[Setback] = field(default_factory=list)
    seconds: float = 0.0
    results: Mapping[str, Results] = field(default_factory=dict)
    unable: list[Setback] = field(default_factory=list)


class Interrupted(KeyboardInterrupt):
    """The exception after Ctrl-C; its message says how many of all cases are stored."""


def sweep(
    study: Study,
    config: Config,
    *,
    fresh: bool = False,
    progress: Progress | None = None,
    argv: Sequence[str] | None = None,
) -> Outcome:
    """Compute the cases of a configuration that are not stored yet; make tables of all cases.

    study, config: the study and its configuration. `config.check` must have been called already.
    fresh: if True, the stored cases of this run are deleted first.
    progress: Receives the progress of the sweep; by default nothing is shown.
    argv: the arguments of the command line, for the manifest; None if the sweep was started from
        Python.
    Returns: What was computed, reused and failed. A failed case raises no exception.
    Raises InputError: Before any case is computed, if the plan is empty, the run folder cannot be
        written or holds another run, or the backend cannot be used.
    Raises Interrupted: After Ctrl-C, once the workers have stopped; this exception is a
        `KeyboardInterrupt`. Stored cases stay, and the next sweep reuses them.
    """
    run = plan_run(study, config)
    with _executor(run) as executor:
        text = dump(config)
        # The plan first: a folder with config.yaml alone would count as one of another version.
        texts = {PLAN_FILE: dump_plan(run.plan(), study, config, text), "config.yaml": text}
        prepare_folder(run, texts, fresh=fresh)
        with run_log(run.folder):
            under_way = _Sweep(Outcome(run), executor, progress or Progress(), text)
            under_way.complete(None if argv is None else list(argv))
        return under_way.outcome


@dataclass
class _Sweep:
    """A sweep that is under way, and what has come out up to now.

    text: the content of config.yaml.
    seconds: Label of each computed block -> its computing time in s.
    warm: whether the engine has warmed up.
    """

    outcome: Outcome
    executor: Executor
    progress: Progress
    text: str
    seconds: dict[str, float] = field(default_factory=dict)
    warm: bool = False

    @property
    def run(self) -> Run:
        return self.outcome.run

    def complete(self, argv: list[str] | None) -> None:
        """Run the sweep and fill in its outcome."""
        began = time.perf_counter()
        own = asked.question_folder(self.run.folder, self.run.question)
        earlier = read_earlier_seconds(self.run.folder) | read_earlier_seconds(own)
        others = was_running(self.run.folder)
        manifest = start_manifest(
            self.run.study, self.run.config, self.text, argv=argv,
            backend=self.executor.work.backend, workers=self.executor.workers,
        )  # fmt: skip
        self._write_manifest(manifest)
        outcome, state = self.outcome, "error"
        try:
            self._compute(self.run.plan(), others)
            while further := self._plan_look(began):
                self._compute(further, others)
            outcome.results = self._aggregate()
            state = "incomplete" if outcome.failed else "done"
        except KeyboardInterrupt as error:
            state = "interrupted"
            total = count_cases(self.run.plan())
            raise Interrupted(
                f"interrupted; {self._count_stored()} of {total} cases are stored in "
                f"{self.run.folder}/"
            ) from error
        finally:
            self.progress.stop()
            outcome.seconds = time.perf_counter() - began
            failed = sum(failure.cases for failure in outcome.failed)
            told = (state, outcome.computed, failed, outcome.seconds)
            logger.info("%s: %d computed, %d failed in %.1f s", *told)
            cases = {"computed": outcome.computed, "reused": outcome.reused, "failed": failed}
            labels = {block.label for block in self.run.plan().values()}
            each = {k: v for k, v in (earlier | self.seconds).items() if k in labels}
            self._write_manifest(finish_manifest(manifest, state, outcome.seconds, cases, each))

    def _compute(self, plan: Plan, others: bool) -> None:
        """Compute the blocks of a part of the plan that are not stored."""
        store = self.run.store
        if not others:  # another sweep may have computed a block anew just now: keep that block
            self._drop_doubtful(plan)
        missing = {key: block for key, block in plan.items() if store.status(key) != "done"}
        total = count_cases(plan)
        reused = total - count_cases(missing)
        self.outcome.reused += reused
        logger.info("%d cases, %d of them stored already", total, reused)
        todo = make_tasks(missing)
        if others:
            # Another sweep may work on this run: start at the other end, to share the work.
            todo.reverse()
        if todo and not self.warm:
            self.warm = True
            for config in self.run.config.by_tuning().values():
                self.run.engine.warm_up(config)
        self.progress.start(total, reused)
        with closing(self.executor.run(todo, self.progress.advance)) as results:
            for result in results:
                self._take(result)

    def _plan_look(self, began: float) -> Plan:
        """Add the blocks of the next look to the plan, and return them; {} if there is none."""
        records = self.run.config.records
        if records is None or not records.decides:
            return {}
        plan, (stored, _) = self.run.plan(), self.run.stored()
        with blame(self.run.study):
            whole, found = plan_look(self.run.study, self.run.config, plan, stored)
        further = {key: block for key, block in whole.items() if key not in plan}
        if not further:
            return {}
        logger.info("%s", found)
        seconds = time.perf_counter() - began
        if records.budget is not None and seconds > records.budget:
            logger.warning(
                "%s; no further look, because %.3g s have passed of grid.budget=%g; the same "
                "command goes on", found, seconds, records.budget,
            )  # fmt: skip
            return {}
        self.progress.look(found)
        self.outcome.run = replace(self.run, stored_plan=whole)
        content = dump_plan(whole, self.run.study, self.run.config, self.text)
        asked.write_both(self.run.folder, self.run.question, {PLAN_FILE: content})
        return further

    def _drop_doubtful(self, plan: Plan) -> None:
        """Delete stored blocks (units of work) that must be recomputed, and log why.

        The attribute `recompute` of such a block gives the reason.
        """
        store = self.run.store
        reasons: dict[str, int] = {}
        for key, block in plan.items():
            if block.recompute and store.path(key).exists():
                store.path(key).unlink(missing_ok=True)  # another sweep may delete the file first
                reasons[block.recompute] = reasons.get(block.recompute, 0) + block.cases
        for reason, cases in reasons.items():
            logger.warning("%d stored cases are recomputed: %s", cases, reason)

    def _take(self, result: TaskResult) -> None:
        repeat(result.records)
        self.outcome.computed += result.computed
        self.outcome.reused += result.reused
        self.seconds.update(result.seconds)
        self._fail(result.failures)
        if result.details:
            logger.info("%s", result.details)
        over = result.computed + result.reused + sum(fail.cases for fail in result.failures)
        if over > result.told:
            self.progress.advance(over - result.told)

    def _fail(self, failures: Sequence[Setback]) -> None:
        self.outcome.failed += failures
        for failure in failures:
            logger.warning("failed: %s: %s", failure.label, failure.reason)
            self.progress.fail(failure.label, failure.reason, failure.cases)

    def _count_stored(self) -> int:
        """Return the number of the plan's cases that are stored and have not failed.

        Cases that were stored by tasks whose workers did not report count too.
        """
        store = self.run.store
        present = {path.name for path in store.cases.glob("part-*.parquet")}
        plan = self.run.plan()
        there = [block for key, block in plan.items() if store.path(key).name in present]
        labels = {block.label for block in there}
        failed = sum(failure.cases for failure in self.outcome.failed if failure.label in labels)
        return sum(block.cases for block in there) - failed

    def _aggregate(self) -> dict[str, Results]:
        """Write the study's tables; return the results by tuning.

        Return {}, and write nothing, if no case has succeeded or if the tables cannot be made.
        """
        run = self.run
        stored, _ = run.stored()
        if any((rows["status"] == UNABLE).any() for rows in stored.values()):
            self.outcome.unable = run.unable()
        try:
            results = run.make_results(stored)
        except InputError as error:  # no case is lost: all are stored
            self._fail([Setback("no tables were made", str(error), 0)])
            return {}
        if not results:
            logger.warning("no case has succeeded: there are no tables")
            return {}
        tables = join_tables(results)
        try:
            asked.write_both(run.folder, run.question, dump_tables(tables))
        except OSError as error:
            names = ", ".join(f"{name}.csv" for name in tables)
            self._fail([Setback(f"{names} (left as they were)", one_line(error), 0)])
        return results

    def _write_manifest(self, manifest: Plain) -> None:
        text = json.dumps(manifest, indent=2) + "\n"
        try:
            asked.write_both(self.run.folder, self.run.question, {MANIFEST: text})
        except OSError as error:  # the stored cases matter more than the manifest
            logger.warning("manifest.json could not be written (%s)", one_line(error))


@contextmanager
def _executor(run: Run) -> Iterator[Executor]:
    from joblib import cpu_count

    compute = run.config.compute
    backend = compute.backend if compute.backend != "auto" else _suitable_backend(run)
    require(
        backend in BACKENDS,
        f"study {run.study.name}: its backend is {backend!r}; a study says threading or loky",
    )
    # Absolute: workers outlive a sweep and keep their first working directory.
    store = replace(run.store, folder=run.folder.absolute())
    work = Work(run.study, run.config, store, all_versions(run.study), backend)
    if backend != "dask":
        # joblib's count respects the affinity mask and the quota of a container.
        yield Executor(work, compute.workers or cpu_count())
        return
    require(
        find_spec("distributed") is not None,
        "compute.backend: dask is not installed; use pip install 'owtsweep[dask]'",
    )
    from owtsweep.sweep.cluster import connected

    with connected(str(compute.scheduler), run.study, work.metadata) as client:
        yield Executor(work, compute.workers, client)


def _suitable_backend(run: Run) -> str:
    """Return the backend that suits the blocks of all tunings: processes if any needs them."""
    suitable = [run.engine.backend(config) for config in run.config.by_tuning().values()]
    return next((backend for backend in suitable if backend != "threading"), "threading")
