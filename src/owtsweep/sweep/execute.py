"""Gives tasks to joblib, and stores what comes back."""

from __future__ import annotations

import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pickle import PicklingError
from typing import TYPE_CHECKING, Any

from owtsweep.config import Config
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.setback import Setback
from owtsweep.sweep.shard import DamagedShard, decode
from owtsweep.sweep.store import Store
from owtsweep.sweep.study import Study
from owtsweep.sweep.token import shared_token
from owtsweep.sweep.worker import (
    NOT_COMPUTED,
    Local,
    TaskResult,
    Work,
    is_disk_full,
    one_line,
    run_task,
)

if TYPE_CHECKING:
    from owtsweep.sweep.cluster import Lost

PLACES = {"threading": "thread", "loky": "process", "dask": "cluster"}


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
        The joblib backend and how many workers it gets; 0 means a whole cluster.
    client
        The connection to a cluster (`owtsweep.sweep.cluster.connected`), for backend "dask".
    """

    study: Study
    config: Config
    store: Store
    metadata: Mapping[str, str]
    backend: str
    workers: int
    client: Any = None

    def run(
        self, tasks: Sequence[Plan], tell: Callable[[int], None] | None = None
    ) -> Generator[TaskResult]:
        """Run the tasks; yields each result as it comes.

        Closing the iterator stops the workers: processes at once, threads after the block they are
        at, since a thread cannot be ended from outside.

        Parameters
        ----------
        tasks
            Blocks by key.
        tell
            Called by threads with the cases of each block that is over.
        """
        if not tasks:
            return
        queue = list(tasks)
        reported: set[int] = set()
        with self._share_folder() as work, self._prepare_workers() as start:
            local = self._make_local(tell)
            try:
                with closing(self._run_rounds(work, queue, start, local)) as results:
                    for result in results:
                        reported.add(result.task)
                        kept = self._store_returned(result)
                        yield kept
                        if kept.disk_full:
                            raise _Stop(NOT_COMPUTED)
            except _Stop as stop:
                for number in sorted(set(range(len(queue))) - reported):
                    yield self._count_stored(number, queue[number], str(stop))
            finally:
                if local is not None:
                    local.stop.set()

    def _make_local(self, tell: Callable[[int], None] | None) -> Local | None:
        # Processes cannot share a flag (it does not pickle) and need not.
        if self.backend != "threading":
            return None
        return Local(threading.Event(), tell or (lambda cases: None))

    def _run_rounds(
        self, work: Work, tasks: list[Plan], start: Callable[[int], Any], local: Local | None
    ) -> Generator[TaskResult]:
        """Run all tasks, and again those whose worker died, until the guilty block is alone.

        A broken pool of processes does not say which task broke it. All that were under way are
        suspects; they run again, one half after the other, until one task is left. Its blocks then
        run as one task each, appended to `tasks`.
        """
        rounds = deque([list(range(len(tasks)))])
        while rounds:
            numbers = rounds.popleft()
            sent: list[int] = []
            reported: set[int] = set()
            guilty: dict[int, str] = {}
            try:
                for result in self._run_round(work, tasks, numbers, sent, start, local):
                    reported.add(result.task)
                    if isinstance(result, TaskResult):
                        yield result
                    else:
                        guilty[result.task] = result.reason
                # A task that the backend has lost must not be passed over.
                guilty |= dict.fromkeys(set(numbers) - reported, "its worker gave no answer")
            except PicklingError as error:
                raise _Stop(one_line(error)) from error
            except BrokenExecutor as error:
                suspects = [number for number in sent if number not in reported]
                rest = numbers[len(sent) :]
                if len(suspects) == 1:
                    guilty[suspects.pop()] = one_line(error)
                elif len(suspects) == len(numbers):
                    half = len(suspects) // 2
                    suspects, rest = suspects[:half], suspects[half:]
                rounds.extendleft(part for part in (rest, suspects) if part)
            for number, reason in guilty.items():
                missing = {
                    key: block
                    for key, block in tasks[number].items()
                    if self.store.status(key) != "done"
                }
                if len(missing) < 2:
                    yield self._count_stored(number, tasks[number], reason)
                    continue
                done = {key: block for key, block in tasks[number].items() if key not in missing}
                yield self._count_stored(number, done, reason)
                for key, block in missing.items():
                    rounds.append([len(tasks)])
                    tasks.append({key: block})

    def _run_round(
        self,
        work: Work,
        tasks: Sequence[Plan],
        numbers: list[int],
        sent: list[int],
        start: Callable[[int], Any],
        local: Local | None,
    ) -> Iterator[TaskResult | Lost]:
        from joblib import delayed

        def calls() -> Iterator[Any]:
            for number in numbers:
                sent.append(number)
                yield delayed(run_task)(work, number, tasks[number], local)

        if local is not None:
            local.stop.clear()  # the round before has set it for whoever was still at work
        with _hold_interrupts(self.backend == "loky"):
            results: Any = start(len(numbers))(calls())
        try:
            for result in results:
                if not isinstance(result, TaskResult) and result.final:
                    raise _Stop(result.reason)
                yield result
        finally:
            if local is not None:
                local.stop.set()
            with warnings.catch_warnings():
                # joblib remarks that tasks were cancelled: that is what closing is for.
                warnings.simplefilter("ignore", UserWarning)
                results.close()

    @contextmanager
    def _share_folder(self) -> Iterator[Work]:
        """What workers are told; a file shows those elsewhere whether they see the run folder."""
        place: Any = PLACES[self.backend]
        work = Work(self.study, self.config, self.store, self.metadata, place)
        if place != "cluster":
            yield work
            return
        with shared_token(self.store.folder) as token:
            yield replace(work, token=token)

    @contextmanager
    def _prepare_workers(self) -> Iterator[Callable[[int], Any]]:
        """How to make a `joblib.Parallel` for so many tasks."""
        from joblib import Parallel, parallel_config

        options: dict[str, Any] = {"return_as": "generator_unordered", "batch_size": 1}
        if self.backend != "dask":
            # One job would run in this very process, and a block may kill its worker.
            least = 2 if self.backend == "loky" else 1

            def local(tasks: int) -> Any:
                workers = min(self.workers, tasks)
                return Parallel(
                    n_jobs=max(workers, least),
                    backend=self.backend,
                    pre_dispatch=workers if workers < least else "2*n_jobs",
                    **options,
                )

            yield local
            return
        from owtsweep.sweep.cluster import Backend

        # joblib takes the whole cluster; `workers` limits how many tasks it gets at a time.
        with parallel_config(backend=Backend(self.client)):
            yield lambda tasks: Parallel(pre_dispatch=self.workers or "2*n_jobs", **options)

    def _store_returned(self, result: TaskResult) -> TaskResult:
        """Store the shards that a worker has handed back."""
        failures = list(result.failures)
        computed, disk_full = result.computed, result.disk_full
        for shard in result.returned:
            try:
                decode(shard.data, shard.key)
                self.store.write_sealed(shard.key, shard.data)
            except (DamagedShard, OSError) as error:
                computed -= shard.succeeded
                disk_full = disk_full or is_disk_full(error)
                failures.append(Setback(shard.label, one_line(error), shard.succeeded))
        return replace(
            result, computed=computed, failures=tuple(failures), returned=(), disk_full=disk_full
        )

    def _count_stored(self, number: int, blocks: Plan, reason: str) -> TaskResult:
        """The result of a task that did not report: what was stored is kept."""
        computed = 0
        failures = []
        for key, block in blocks.items():
            if self.store.status(key) == "done":
                computed += block.cases
            else:
                failures.append(Setback(block.label, reason, block.cases))
        return TaskResult(number, computed, tuple(failures))


@contextmanager
def _hold_interrupts(hold: bool) -> Iterator[None]:
    """Let Ctrl-C wait while processes are started.

    They inherit it: one that is still loading its libraries does not die of the terminal's Ctrl-C
    with a traceback.
    """
    if not hold or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Stop(Exception):
    """Nothing more can be computed: a full disk, a cluster that is gone; the message says why."""
