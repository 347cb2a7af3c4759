"""Runs tasks through joblib and stores their results."""

from __future__ import annotations

import secrets
import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import closing, contextmanager, nullcontext, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from pickle import PicklingError
from typing import TYPE_CHECKING, Any

from owtsweep.sweep.plan import Plan
from owtsweep.sweep.rows import Setback
from owtsweep.sweep.schema import WrongRows
from owtsweep.sweep.shard import DamagedShard, decode
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

#: The backends of joblib that a sweep can use.
BACKENDS = ("threading", "loky", "dask")


@dataclass(frozen=True)
class Executor:
    """Runs tasks of a study and stores their shards.

    Attributes
    ----------
    work
        What its workers need to know.
    workers
        How many workers there are; 0 means a whole cluster.
    client
        The connection to a cluster (`owtsweep.sweep.cluster.connected`), for backend "dask".
    """

    work: Work
    workers: int
    client: Any = None

    def run(self, tasks: Sequence[Plan], tell: Callable[[int], None]) -> Generator[TaskResult]:
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
        backend, folder = self.work.backend, self.work.store.folder
        queue = list(tasks)
        reported: set[int] = set()
        # Processes cannot share a flag (it does not pickle), and they do not need it.
        local = Local(threading.Event(), tell) if backend == "threading" else None
        sharing = shared_token(folder) if backend == "dask" else nullcontext()
        with sharing as token:
            work = replace(self.work, token=token)
            try:
                with closing(self._run_rounds(work, queue, local)) as results:
                    for result in results:
                        reported.add(result.task)
                        self._store_returned(result)
                        yield result
                        if result.disk_full:
                            raise _Stop(NOT_COMPUTED)
            except _Stop as stop:
                for number in sorted(set(range(len(queue))) - reported):
                    yield self._count_stored(number, queue[number], str(stop))
            finally:
                if local is not None:
                    local.stop.set()

    def _run_rounds(
        self, work: Work, tasks: list[Plan], local: Local | None
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
                for result in self._run_round(work, tasks, numbers, sent, local):
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
                blocks = tasks[number]
                missing = [key for key in blocks if not self._is_done(key)]
                if len(missing) > 1:
                    for key in missing:
                        rounds.append([len(tasks)])
                        tasks.append({key: blocks[key]})
                    blocks = {key: blocks[key] for key in blocks if key not in missing}
                yield self._count_stored(number, blocks, reason)

    def _run_round(
        self,
        work: Work,
        tasks: Sequence[Plan],
        numbers: list[int],
        sent: list[int],
        local: Local | None,
    ) -> Iterator[TaskResult | Lost]:
        from joblib import delayed

        def calls() -> Iterator[Any]:
            for number in numbers:
                sent.append(number)
                yield delayed(run_task)(work, number, tasks[number], local)

        if local is not None:
            local.stop.clear()  # the previous round set it to stop the workers that were left
        with _hold_interrupts(self.work.backend == "loky"):
            results: Any = self._make_parallel(len(numbers))(calls())
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

    def _make_parallel(self, tasks: int) -> Any:
        """A `joblib.Parallel` for a number of tasks."""
        from joblib import Parallel

        options: dict[str, Any]
        if self.work.backend == "dask":
            from owtsweep.sweep.cluster import Backend

            # joblib uses the whole cluster; `workers` limits how many tasks are submitted at a time
            options = {"backend": Backend(self.client), "pre_dispatch": self.workers or "2*n_jobs"}
        else:
            workers = min(self.workers, tasks)
            # With one job joblib would run it in this thread: it could kill this process, and
            # neither would Ctrl-C end it nor could its own KeyboardInterrupt be told from Ctrl-C.
            options = {
                "n_jobs": max(workers, 2),
                "backend": self.work.backend,
                "pre_dispatch": 1 if workers == 1 else "2*n_jobs",
            }
        return Parallel(return_as="generator_unordered", batch_size=1, **options)

    def _store_returned(self, result: TaskResult) -> None:
        """Store the shards that a worker has handed back."""
        for shard in result.returned:
            try:
                decode(shard.data, shard.key, self.work.store.needed)
                self.work.store.write(shard.key, shard.data)
            except (DamagedShard, WrongRows, OSError) as error:
                result.computed -= shard.succeeded
                result.disk_full = result.disk_full or is_disk_full(error)
                result.failures.append(Setback(shard.label, one_line(error), shard.succeeded))
        result.returned.clear()

    def _count_stored(self, number: int, blocks: Plan, reason: str) -> TaskResult:
        """The result of a task that did not report; its stored blocks count as computed."""
        result = TaskResult(number)
        for key, block in blocks.items():
            if self._is_done(key):
                result.computed += block.cases
            else:
                result.failures.append(Setback(block.label, reason, block.cases))
        return result

    def _is_done(self, key: str) -> bool:
        return self.work.store.status(key) == "done"


@contextmanager
def shared_token(folder: Path) -> Iterator[str | None]:
    """The name of a file in the run folder that exists while the context is open.

    A machine that finds the file shares the folder: the name is random, so a folder with the same
    path on another machine does not contain it. The name is None if the file cannot be written;
    then workers send their shards back.
    """
    # Named like a temporary file, so that one left by a killed sweep is cleaned up too.
    path = folder / f".shared.{secrets.token_hex(8)}.tmp"
    try:
        path.touch(exist_ok=False)
    except OSError:
        yield None
        return
    try:
        yield path.name
    finally:
        with suppress(OSError):
            path.unlink()


@contextmanager
def _hold_interrupts(hold: bool) -> Iterator[None]:
    """Delay Ctrl-C and the end of the terminal while processes are started.

    The processes inherit the blocked signals. Both reach the whole group: a process that is still
    loading its libraries would die of Ctrl-C with a traceback, and joblib's own process that
    tidies up would die of the other, with one traceback for each thing that it knew.
    """
    if not hold or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT, signal.SIGHUP])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Stop(Exception):
    """Nothing more can be computed: a full disk, a cluster that is gone; the message says why."""
