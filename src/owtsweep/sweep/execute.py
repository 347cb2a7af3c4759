"""Runs the tasks of a sweep, here or on a cluster, and stores the results of the tasks."""

from __future__ import annotations

import os
import secrets
import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import closing, contextmanager, nullcontext, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from pickle import PicklingError
from typing import TYPE_CHECKING, Any

from owtsweep import compiled  # in this form the module counts as no source of kernels
from owtsweep.process import no_modules_of_this_folder
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.rows import Setback, WrongRows
from owtsweep.sweep.store import DamagedShard, decode
from owtsweep.sweep.worker import (
    NOT_COMPUTED,
    Local,
    TaskResult,
    Work,
    begin_process,
    is_disk_full,
    one_line,
    run_task,
)

if TYPE_CHECKING:
    from distributed import Client

#: What can run the tasks of a sweep: two backends of joblib, and a dask cluster.
BACKENDS = ("threading", "loky", "dask")


@dataclass(frozen=True)
class Executor:
    """The executor, which runs the tasks of a sweep and stores the results.

    work: What the workers need to know.
    workers: Number of workers; 0 means all workers of a cluster.
    client: the connection to a cluster (`owtsweep.sweep.cluster.connected`) if the backend is
        "dask"; otherwise None.
    """

    work: Work
    workers: int
    client: Client | None = None

    def run(self, tasks: Sequence[Plan], tell: Callable[[int], None]) -> Generator[TaskResult]:
        """Run the tasks, and yield the result of each task as soon as the result arrives.

        Closing the generator stops the workers. Processes stop at once. Threads stop after their
        current block (unit of work), because a thread cannot be ended from outside.

        tasks: the tasks, each of which maps the keys of its blocks to the blocks.
        tell: a function that threads call with the number of cases of each finished block.
            Processes and other machines do not call this function.
        """
        if not tasks:
            return
        backend, folder = self.work.backend, self.work.store.folder
        queue = list(tasks)
        reported: set[int] = set()
        # Processes cannot share a flag (it does not pickle), and they do not need it.
        local = Local(threading.Event(), tell) if backend == "threading" else None
        sharing = _share_file(folder) if backend == "dask" else nullcontext()
        with no_modules_of_this_folder(), sharing as file:
            work = replace(self.work, shared=file, local=local)
            try:
                with closing(replace(self, work=work)._run_rounds(queue)) as results:
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

    def _run_rounds(self, tasks: list[Plan]) -> Generator[TaskResult]:
        """Run all tasks, and yield their results; if a worker dies, find the block that killed it.

        A block is a part of a task, stored as one file. A broken pool of processes does not say
        which task has broken the pool. So all tasks that were running are suspects. The suspects
        run again, one half after the other, until a single suspect is left. Then each of the
        suspect's blocks runs as a task of its own, which is appended to `tasks`.
        """
        rounds = deque([list(range(len(tasks)))])
        while rounds:
            numbers = rounds.popleft()
            sent: list[int] = []
            reported: set[int] = set()
            guilty: dict[int, str] = {}
            try:
                for result in self._run_round(tasks, numbers, sent):
                    reported.add(result.task)
                    if result.lost:
                        guilty[result.task] = result.lost
                    else:
                        yield result
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
        self, tasks: Sequence[Plan], numbers: list[int], sent: list[int]
    ) -> Iterator[TaskResult]:
        """Run the tasks of some numbers; `sent` receives each number before its task begins."""
        work, local = self.work, self.work.local
        if self.client is not None:
            from owtsweep.sweep.cluster import run_tasks

            there = {number: partial(run_task, work, number, tasks[number]) for number in numbers}
            try:
                yield from run_tasks(self.client, there, self.workers)
            except ConnectionError as error:
                raise _Stop(str(error)) from error
            return
        from joblib import delayed

        def calls() -> Iterator[object]:
            for number in numbers:
                sent.append(number)
                yield delayed(run_task)(work, number, tasks[number])

        if local is not None:
            local.stop.clear()  # the previous round set it to stop the workers that were left
        with _hold_interrupts(work.backend == "loky"):
            results: Generator[TaskResult] = self._make_parallel(len(numbers))(calls())
        try:
            yield from results
        finally:
            if local is not None:
                local.stop.set()
            with warnings.catch_warnings():
                # joblib warns that tasks were cancelled, which is the purpose of closing.
                warnings.simplefilter("ignore", UserWarning)
                results.close()

    def _make_parallel(self, tasks: int) -> Any:
        """Return a `joblib.Parallel` for the backend; `tasks` is the number of tasks to run."""
        from joblib import Parallel

        workers = min(self.workers, tasks)
        # At least two jobs: with one, joblib would run the tasks in this thread. A task could then
        # kill this process, Ctrl-C would not end it, and a KeyboardInterrupt that a task raises
        # would look like Ctrl-C.
        options: dict[str, Any] = {
            "n_jobs": max(workers, 2),
            "backend": self.work.backend,
            "pre_dispatch": 1 if workers == 1 else "2*n_jobs",
        }
        if self.work.backend == "loky":
            compiled.name_command()
            options |= {"initializer": begin_process, "initargs": (os.getpid(),)}
        return Parallel(return_as="generator_unordered", batch_size=1, **options)

    def _store_returned(self, result: TaskResult) -> None:
        """Store the shards that a worker has sent back because it could not write them.

        A shard is the file of one block. If a shard cannot be stored, `result` is changed: the
        shard's cases then count as failed.
        """
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
        """Make the result of task number `number`, whose worker has given no answer.

        `blocks` maps keys to the task's blocks. Blocks that are stored count as computed; all other
        blocks count as failed for `reason`.
        """
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
def _share_file(folder: Path) -> Iterator[str | None]:
    """Make a file in the run folder, yield its path, and delete the file at the end.

    A worker on another machine that finds the file sees the run folder itself. The file's name is
    random, so another folder with the same path does not contain the file. If the file cannot be
    written, yield None; then workers send their results back instead of storing them.
    """
    # Named like a temporary file, so that one left by a killed sweep is cleaned up too.
    path = folder / f".shared.{secrets.token_hex(8)}.tmp"
    try:
        path.touch(exist_ok=False)
    except OSError:
        yield None
        return
    try:
        yield str(path)
    finally:
        with suppress(OSError):  # another sweep may have cleaned up
            path.unlink()


@contextmanager
def _hold_interrupts(hold: bool) -> Iterator[None]:
    """Block the signals SIGINT (Ctrl-C) and SIGHUP (the terminal ends) inside the context.

    Processes started inside the context inherit the blocked signals. Otherwise both signals would
    reach all of these processes. A process that is still loading its libraries would die of SIGINT
    with a traceback. joblib's resource tracker would die of SIGHUP with many tracebacks. No signal
    is blocked if `hold` is False, or if the current thread is not the main thread.
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
    """The exception that ends a sweep early, e.g. if the disk is full; the message says why."""
