"""Runs tasks through joblib and stores their results."""

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
        Entries stored in every shard: versions.
    backend, workers
        The joblib backend and its number of workers; 0 means a whole cluster.
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
        """Run the tasks and yield each result as it arrives.

        Closing the iterator stops the workers: processes at once, threads after their current
        block, since a thread cannot be ended from outside.

        Parameters
        ----------
        tasks
            Blocks by key.
        tell
            Called by threads with the number of cases of each finished block.
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
        # Processes cannot share a flag (it does not pickle), and they do not need it.
        if self.backend != "threading":
            return None
        return Local(threading.Event(), tell or (lambda cases: None))

    def _run_rounds(
        self, work: Work, tasks: list[Plan], start: Callable[[int], Any], local: Local | None
    ) -> Generator[TaskResult]:
        """Run all tasks. If a worker dies, run tasks again until the block that killed it is found.

        A broken pool of processes does not say which task broke it. All tasks that were running are
        suspects. They run again, one half after the other, until one suspect is left. Each of its
        blocks then runs as a task of its own, appended to `tasks`.
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
                # A task that the backend has lost must count as failed.
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
            local.stop.clear()  # the previous round set it to stop the workers that were left
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
                # joblib warns that tasks were cancelled, which is the purpose of closing.
                warnings.simplefilter("ignore", UserWarning)
                results.close()

    @contextmanager
    def _share_folder(self) -> Iterator[Work]:
        """The `Work` of the workers; its token shows other machines whether they see the folder."""
        place: Any = PLACES[self.backend]
        work = Work(self.study, self.config, self.store, self.metadata, place)
        if place != "cluster":
            yield work
            return
        with shared_token(self.store.folder) as token:
            yield replace(work, token=token)

    @contextmanager
    def _prepare_workers(self) -> Iterator[Callable[[int], Any]]:
        """A function that makes a `joblib.Parallel` for a number of tasks."""
        from joblib import Parallel, parallel_config

        options: dict[str, Any] = {"return_as": "generator_unordered", "batch_size": 1}
        if self.backend != "dask":
            # With one job joblib would run it in this process, and a block may kill its process.
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

        # joblib uses the whole cluster; `workers` limits how many tasks are submitted at a time.
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
        """The result of a task that did not report; its stored blocks count as computed."""
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
    """Delay Ctrl-C while processes are started.

    The processes inherit the blocked signal, so a process that is still loading its libraries does
    not die of Ctrl-C with a traceback.
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
