"""Runs in a worker (a thread, a process or another machine): computes and stores blocks.

A block is the unit of work; its rows are stored in one file, the shard. A worker writes each shard
as soon as the block is done. If the worker does not see the run folder, it returns the shard
instead. A worker catches every exception but Ctrl-C, because joblib drops its whole queue if an
exception escapes.
"""

from __future__ import annotations

import errno
import os
import signal
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from logging import LogRecord
from typing import TYPE_CHECKING

from owtsweep._version import __version__
from owtsweep.config import Config
from owtsweep.errors import as_text
from owtsweep.process import keep_freed_memory
from owtsweep.sweep.keys import block_key, list_versions
from owtsweep.sweep.log import collect_records, working_on
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.rows import Setback, collect_setbacks
from owtsweep.sweep.store import Store, encode
from owtsweep.sweep.study import FAILED, Block, Study

if TYPE_CHECKING:
    import pandas as pd

#: Error numbers of a full disk or quota; after such an error a sweep stops.
DISK_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
NOT_COMPUTED = "not computed, because the disk is full"
#: Seconds after which a worker process looks again whether its parent is there.
LOOK = 1.0


@dataclass(frozen=True)
class Returned:
    """A shard (the file of one block) that a worker could not write into the run folder.

    `key` and `label` are those of the block, `data` are the shard's bytes, and `succeeded` is the
    number of the block's cases that have not failed.
    """

    key: str
    label: str
    data: bytes
    succeeded: int


@dataclass
class TaskResult:
    """The result of a task (some blocks that run together), which the worker fills in.

    task: the number of the task.
    computed, reused: Number of cases computed, and of cases that another sweep had stored
        meanwhile.
    failures: Cases that failed. Unless the sweep was stopped, each case of the task is computed,
        reused or failed.
    details: Tracebacks of failed blocks; "" if no block raised an exception.
    seconds: Label of each computed block -> its computing time in s.
    returned: Shards that the process which started the sweep must store.
    records: Messages logged in another process or machine; empty for a thread.
    disk_full: whether a shard could not be written because the disk is full.
    told: Number of cases that the worker, if it is a thread, has already reported to the progress.
    lost: why a cluster has lost the task, of which nothing else is known then.
    """

    task: int
    computed: int = 0
    reused: int = 0
    failures: list[Setback] = field(default_factory=list)
    details: str = ""
    seconds: dict[str, float] = field(default_factory=dict)
    returned: list[Returned] = field(default_factory=list)
    records: list[LogRecord] = field(default_factory=list)
    disk_full: bool = False
    told: int = 0
    lost: str = ""


@dataclass(frozen=True)
class Local:
    """What threads share with the sweep that started them: a stop flag and a progress callback.

    `tell` takes the number of cases of a finished block. Processes and other machines have no such
    object.
    """

    stop: threading.Event
    tell: Callable[[int], None]


@dataclass(frozen=True)
class Work:
    """What a worker needs to know; it is pickled for processes and other machines.

    study, config: the study and its configuration.
    store: the store into which the shards are written.
    metadata: Entries stored in every shard: the versions in the process that started the sweep.
    backend: What runs the tasks: "threading", "loky" (processes) or "dask" (a cluster).
    shared: the path of a file in the run folder, by which another machine recognises that it sees
        this folder. None if there is no such file.
    local: what a thread shares with the sweep; None for processes and other machines.
    """

    study: Study
    config: Config
    store: Store
    metadata: Mapping[str, str]
    backend: str
    shared: str | None = None
    local: Local | None = None

    def shares_folder(self) -> bool:
        """Return whether the worker sees the run folder of the process that started the sweep.

        On another machine, a different folder may have the same path.
        """
        if self.backend != "dask":
            return True
        return self.shared is not None and os.path.isfile(self.shared)


def all_versions(study: Study) -> dict[str, str]:
    """Return a study's name and versions, and the version of owtsweep, all as text.

    The keys are study, schema_version, numerics_version and owtsweep_version.
    """
    entries = {**list_versions(study), "owtsweep_version": __version__}
    return {name: str(value) for name, value in entries.items()}


def tell_other_versions(study: Study, expected: Mapping[str, str]) -> str:
    """Return in one line how the versions of a worker differ from `expected`; "" if they agree.

    This function runs on the worker. `expected` is what `all_versions` returns in the process that
    started the sweep.
    """
    ours = all_versions(study)
    differing = [name for name, value in expected.items() if ours.get(name, value) != value]
    if not differing:
        return ""
    told = ", ".join(f"{name} {ours[name]} instead of {expected[name]}" for name in differing)
    return f"the worker has {told}; give it the coordinator's version of owtsweep"


def run_task(work: Work, number: int, blocks: Plan) -> TaskResult:
    """Run the blocks (units of work) of one task, and store each block as soon as it is done.

    Return the result of the task, whose number is `number`. If a block raises an exception, only
    this block fails, and the remaining blocks are run. If the worker's versions of owtsweep and the
    study differ from the versions in `work`, all blocks fail.
    """
    result = TaskResult(number)
    differs = tell_other_versions(work.study, work.metadata)
    if differs:
        result.failures += [Setback(b.label, differs, b.cases) for b in blocks.values()]
        return result
    with collect_records(work.backend != "threading") as records:
        try:
            _Task(work, blocks, result).run()
        finally:
            working_on("")
        result.records += records
    return result


class _Task:
    """A task that is under way in a worker."""

    def __init__(self, work: Work, blocks: Plan, result: TaskResult) -> None:
        self.work, self.local, self.result = work, work.local, result
        self.shares = work.shares_folder()
        self.left = dict(blocks)

    def run(self) -> None:
        self._skip_stored()
        while self.left and not self._stopped():
            try:
                self._run_study()
            except BaseException as error:  # sys.exit() and its like must not end the sweep
                if not self.left or self._is_ctrl_c(error):
                    raise  # no block's: the progress cannot be told, or the user wants to stop
                self._fail(next(iter(self.left)), one_line(error))
                self.result.details += traceback.format_exc()
        if self.result.disk_full:
            for key in list(self.left):
                self._fail(key, NOT_COMPUTED)

    def _run_study(self) -> None:
        blocks = list(self.left.values())
        rows_of = self.work.study.engine(self.work.config).run(self.work.config, blocks)
        began = time.perf_counter()
        working_on(blocks[0].label)
        for block, rows in rows_of:
            self._store(block, rows, time.perf_counter() - began)
            if not self.left or self._stopped():
                return
            working_on(next(iter(self.left.values())).label)
            began = time.perf_counter()
        for key in list(self.left):
            self._fail(key, "RuntimeError: the study gave no rows for it")

    def _skip_stored(self) -> None:
        """Skip the blocks that another sweep has stored meanwhile; their cases count as reused.

        No block is skipped if the worker does not see the run folder.
        """
        for key, block in list(self.left.items()):
            if self.shares and self.work.store.status(key) == "done":
                del self.left[key]
                self.result.reused += block.cases
                self._tell(block.cases)

    def _store(self, block: Block, rows: pd.DataFrame, seconds: float) -> None:
        result = self.result
        key = block_key(self.work.study, block)
        try:
            data = encode(key, rows, self.work.metadata, self.work.store.needed)
            failed = collect_setbacks(block, rows, FAILED)
            succeeded = block.cases - sum(failure.cases for failure in failed)
            if not self._written(key, data):
                result.returned.append(Returned(key, block.label, data, succeeded))
        except Exception as error:
            if is_disk_full(error):
                result.disk_full = True
                if self.local is not None:  # the next task of this thread need not begin
                    self.local.stop.set()
            result.details += traceback.format_exc()
            self._fail(key, one_line(error))
            return
        del self.left[key]
        result.failures += failed
        result.computed += succeeded
        result.seconds[block.label] = seconds
        self._tell(block.cases)

    def _written(self, key: str, data: bytes) -> bool:
        if not self.shares:
            return False
        try:
            self.work.store.write(key, data)
        except OSError:
            # On another machine the folder may be read-only.
            if self.work.backend != "dask":
                raise
            return False
        return True

    def _fail(self, key: str, reason: str) -> None:
        block = self.left.pop(key)
        self.result.failures.append(Setback(block.label, reason, block.cases))
        self._tell(block.cases)

    def _tell(self, cases: int) -> None:
        if self.local is not None:
            self.local.tell(cases)
            self.result.told += cases

    def _is_ctrl_c(self, error: BaseException) -> bool:
        # Python raises the KeyboardInterrupt of Ctrl-C in the main thread only, and the processes
        # of a pool ignore Ctrl-C. Elsewhere a block has raised a KeyboardInterrupt itself.
        at_the_top = threading.current_thread() is threading.main_thread()
        return isinstance(error, KeyboardInterrupt) and at_the_top and self.work.backend != "loky"

    def _stopped(self) -> bool:
        return self.result.disk_full or (self.local is not None and self.local.stop.is_set())


def one_line(error: BaseException) -> str:
    """Return type and message of an exception in one line; only the type if it has no message."""
    return as_text(error).removesuffix(":")


def is_disk_full(error: BaseException) -> bool:
    """Return whether an error means that the disk, or the user's quota, is full."""
    return isinstance(error, OSError) and error.errno in DISK_FULL


def begin_process(parent: int) -> None:
    """Prepare a new worker process, before its first task.

    `parent` is the id of the process that started the sweep. If that process is killed, nobody ends
    its workers, so each worker looks for its parent and ends by itself.
    """
    # Ctrl-C reaches the whole process group. A worker killed by it would break the pool.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keep_freed_memory()
    end_with_parent(parent)


@cache
def end_with_parent(parent: int) -> None:
    """End this process at most `LOOK` seconds after the process `parent`, which has started it.

    On Windows a process keeps the id of its parent, so there nothing is noticed.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(LOOK)
        os._exit(1)  # as the parent was ended: at once

    threading.Thread(target=watch, daemon=True).start()
