"""Running tasks on the workers: what happens in a worker, and how joblib is fed.

A worker writes each shard itself as soon as the block is done, and catches every exception: joblib
gives up its whole queue for one that escapes.
"""

from __future__ import annotations

import threading
import traceback
import warnings
from collections.abc import Generator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from pickle import PicklingError
from typing import TYPE_CHECKING, Any

from owtsweep.config import Config
from owtsweep.studies.base import FAILED, Block, Study
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.store import Store

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Failure:
    """Cases of a block that failed for one reason."""

    label: str
    reason: str
    cases: int


@dataclass(frozen=True)
class TaskResult:
    """What became of a task; `computed` counts cases, `details` is a traceback or empty."""

    task: int
    computed: int
    failures: tuple[Failure, ...]
    details: str = ""


@dataclass(frozen=True)
class Executor:
    """Runs tasks of a study and stores their shards.

    Attributes
    ----------
    study, config
        What is run.
    store
        Where the shards go.
    metadata
        What every shard says about itself: versions.
    backend, workers
        The joblib backend and how many workers it gets.
    """

    study: Study
    config: Config
    store: Store
    metadata: Mapping[str, str]
    backend: str
    workers: int

    def run(self, tasks: Sequence[Plan]) -> Generator[TaskResult]:
        """Run the tasks; yields each result as it comes.

        Closing the iterator stops the workers: processes at once, threads after the block they are
        at, since a thread cannot be ended from outside.
        """
        from joblib import Parallel, delayed

        if not tasks:
            return

        # Threads share the flag. Processes cannot (it does not pickle) and need not.
        stop = threading.Event() if self.backend == "threading" else None
        parallel = Parallel(
            n_jobs=min(self.workers, len(tasks)),
            backend=self.backend,
            return_as="generator_unordered",
            batch_size=1,
        )
        unreported = set(range(len(tasks)))
        results: Any = parallel(
            delayed(run_task)(self, number, blocks, stop) for number, blocks in enumerate(tasks)
        )
        try:
            for result in results:
                unreported.discard(result.task)
                yield result
        except (BrokenExecutor, PicklingError) as error:
            # A worker was killed, or could not be given the task. What was stored is kept.
            for number in sorted(unreported):
                yield self._result_from_store(number, tasks[number], _reason(error))
        finally:
            if stop is not None:
                stop.set()
            with warnings.catch_warnings():
                # joblib remarks that tasks were cancelled: that is what closing is for.
                warnings.simplefilter("ignore", UserWarning)
                results.close()

    def _result_from_store(self, number: int, blocks: Plan, reason: str) -> TaskResult:
        computed = 0
        failures = []
        for key, block in blocks.items():
            if self.store.status(key) == "done":
                computed += block.cases
            else:
                failures.append(Failure(block.label, reason, block.cases))
        return TaskResult(number, computed, tuple(failures))


def run_task(
    executor: Executor, number: int, blocks: Plan, stop: threading.Event | None = None
) -> TaskResult:
    """Run the blocks of one task in a worker and store each as soon as it is done."""
    study = executor.study
    left = dict(blocks)
    computed = 0
    failures: list[Failure] = []
    reason = "RuntimeError: the study gave no rows for it"
    details = ""
    try:
        for block, rows in study.run(executor.config, list(blocks.values())):
            key = block_key(study, block)
            executor.store.write(key, rows, executor.metadata)
            del left[key]
            failed = _failures(block, rows)
            failures += failed
            computed += block.cases - sum(failure.cases for failure in failed)
            if stop is not None and stop.is_set():
                break
    except (Exception, SystemExit) as error:  # a study's code that exits must not end the sweep
        reason = _reason(error)
        details = traceback.format_exc()
    failures += [Failure(block.label, reason, block.cases) for block in left.values()]
    return TaskResult(number, computed, tuple(failures), details)


def _failures(block: Block, rows: pd.DataFrame) -> list[Failure]:
    """The failed cases of a stored block by reason."""
    reasons = rows.loc[rows["status"] == FAILED, "reason"].fillna("no reason given").value_counts()
    each = block.cases_per_row
    return [Failure(block.label, str(reason), each * int(n)) for reason, n in reasons.items()]


def _reason(error: BaseException) -> str:
    """An exception in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())
