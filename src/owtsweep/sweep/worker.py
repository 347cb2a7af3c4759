"""What happens in a worker: a thread, a process or a machine elsewhere computes and stores blocks.

A worker writes each shard itself as soon as the block is done, or hands it back where the run
folder is not its own. It catches every exception: joblib gives up its whole queue for one that
escapes.
"""

from __future__ import annotations

import errno
import signal
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from owtsweep.config import Config
from owtsweep.errors import as_text
from owtsweep.freed_memory import keep_freed_memory
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.log import Record, collected_records, working_on
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.store import Store, seal
from owtsweep.sweep.study import FAILED, Block, Study
from owtsweep.sweep.versions import other_versions

if TYPE_CHECKING:
    import pandas as pd

#: A disk that is full stays full: a sweep that sees one of these does not go on computing.
DISK_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
NOT_COMPUTED = "not computed, because the disk is full"


@dataclass(frozen=True)
class Failure:
    """Cases of a block that failed for one reason."""

    label: str
    reason: str
    cases: int


@dataclass(frozen=True)
class Returned:
    """A sealed shard that its worker could not put into the run folder."""

    key: str
    label: str
    data: bytes
    succeeded: int


@dataclass(frozen=True)
class TaskResult:
    """What became of a task.

    Attributes
    ----------
    task
        Its number.
    computed, reused
        Cases computed, and cases that another sweep had stored meanwhile.
    failures
        The rest, unless the sweep was stopped.
    details
        A traceback, or empty.
    seconds
        Label of each computed block -> seconds.
    returned
        Shards for the coordinator to store.
    records
        What was logged in a worker process.
    disk_full
        Whether a shard met a full disk.
    told
        Cases that a thread has reported as they came.
    """

    task: int
    computed: int
    failures: tuple[Failure, ...]
    details: str = ""
    reused: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    returned: tuple[Returned, ...] = ()
    records: tuple[Record, ...] = ()
    disk_full: bool = False
    told: int = 0


@dataclass(frozen=True)
class Work:
    """What a worker has to know; it travels to processes and to other machines.

    Attributes
    ----------
    study, config
        What is run.
    store
        Where the shards go.
    metadata
        What every shard says about itself: the versions of the coordinator.
    place
        What the worker is to the coordinator.
    token
        File name in the run folder that proves that a machine elsewhere sees the same folder.
    """

    study: Study
    config: Config
    store: Store
    metadata: Mapping[str, str]
    place: Literal["thread", "process", "cluster"]
    token: str | None = None

    def shares_folder(self) -> bool:
        """Whether the worker sees the run folder, and not just a folder of that name."""
        if self.place != "cluster":
            return True
        return self.token is not None and (self.store.folder / self.token).is_file()


@dataclass(frozen=True)
class Local:
    """What only threads share with the coordinator: a flag that stops them, and an ear."""

    stop: threading.Event
    tell: Callable[[int], None]


def run_task(work: Work, number: int, blocks: Plan, local: Local | None = None) -> TaskResult:
    """Run the blocks of one task and store each as soon as it is done.

    A block that raises fails alone: the study is asked again for the blocks after it.
    """
    differs = other_versions(work.study, work.metadata)
    if differs:
        failures = tuple(Failure(b.label, differs, b.cases) for b in blocks.values())
        return TaskResult(number, 0, failures)
    if work.place == "process":
        _leave_interrupts_to_the_coordinator()
        keep_freed_memory()
    with collected_records(work.place != "thread") as records:
        task = _Task(work, number, blocks, local)
        try:
            task.run()
        finally:
            working_on("")
        return task.result(tuple(records))


class _Task:
    """The state of a task under way."""

    def __init__(self, work: Work, number: int, blocks: Plan, local: Local | None) -> None:
        self.work, self.number, self.local = work, number, local
        self.shares = work.shares_folder()
        self.left = dict(blocks)
        self.computed = self.reused = self.told = 0
        self.failures: list[Failure] = []
        self.details: list[str] = []
        self.seconds: dict[str, float] = {}
        self.returned: list[Returned] = []
        self.disk_full = False

    def result(self, records: tuple[Record, ...]) -> TaskResult:
        return TaskResult(
            self.number,
            self.computed,
            tuple(self.failures),
            "".join(self.details),
            self.reused,
            self.seconds,
            tuple(self.returned),
            records,
            self.disk_full,
            self.told,
        )

    def run(self) -> None:
        self._skip_stored()
        while self.left and not self._stopped():
            try:
                self._run_study()
            except (Exception, SystemExit) as error:  # a study's code that exits ends no sweep
                self._fail(next(iter(self.left)), one_line(error))
                self.details.append(traceback.format_exc())
        if self.disk_full:
            for key in list(self.left):
                self._fail(key, NOT_COMPUTED)

    def _run_study(self) -> None:
        blocks = list(self.left.values())
        rows_of = self.work.study.run(self.work.config, blocks)
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
        """Another sweep on the same folder may have been faster."""
        for key, block in list(self.left.items()):
            if self.shares and self.work.store.status(key) == "done":
                del self.left[key]
                self.reused += block.cases
                self._tell(block.cases)

    def _store(self, block: Block, rows: pd.DataFrame, seconds: float) -> None:
        key = block_key(self.work.study, block)
        try:
            failed = _failures(block, rows)
            succeeded = block.cases - sum(failure.cases for failure in failed)
            data = seal(key, rows, self.work.metadata)
            if not self._written(key, data):
                self.returned.append(Returned(key, block.label, data, succeeded))
        except Exception as error:
            self.disk_full = self.disk_full or is_disk_full(error)
            self.details.append(traceback.format_exc())
            self._fail(key, one_line(error))
            return
        del self.left[key]
        self.failures += failed
        self.computed += succeeded
        self.seconds[block.label] = seconds
        self._tell(block.cases)

    def _written(self, key: str, data: bytes) -> bool:
        if not self.shares:
            return False
        try:
            self.work.store.write_sealed(key, data)
        except OSError:
            # Elsewhere the folder may be there to be read only.
            if self.work.place != "cluster":
                raise
            return False
        return True

    def _fail(self, key: str, reason: str) -> None:
        block = self.left.pop(key)
        self.failures.append(Failure(block.label, reason, block.cases))
        self._tell(block.cases)

    def _tell(self, cases: int) -> None:
        if self.local is not None:
            self.local.tell(cases)
            self.told += cases

    def _stopped(self) -> bool:
        return self.disk_full or (self.local is not None and self.local.stop.is_set())


def one_line(error: BaseException) -> str:
    """An exception in one line."""
    return as_text(error).removesuffix(":")


def is_disk_full(error: BaseException) -> bool:
    """Whether this is the file system saying that nothing more fits."""
    return isinstance(error, OSError) and error.errno in DISK_FULL


def _failures(block: Block, rows: pd.DataFrame) -> list[Failure]:
    """The failed cases of a block by reason."""
    if "status" not in rows.columns or "reason" not in rows.columns:
        return []  # sealing refuses them
    if not (rows["status"].to_numpy() == FAILED).any():
        return []  # pandas takes longer to count nothing than a shard takes to be written
    reasons = rows.loc[rows["status"] == FAILED, "reason"].fillna("no reason given").value_counts()
    each = block.cases_per_row
    return [Failure(block.label, str(reason), each * int(n)) for reason, n in reasons.items()]


def _leave_interrupts_to_the_coordinator() -> None:
    # Ctrl-C reaches the whole process group. A worker that dies of it by itself is a broken pool.
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
