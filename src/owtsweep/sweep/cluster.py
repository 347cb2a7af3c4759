"""Computes on other machines: on a dask cluster, driven through a backend of joblib.

This module is imported on demand, because `dask[distributed]` is an optional dependency and takes
half a second to load.
"""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

from distributed import Client, Security
from distributed.core import connect

# A private module, but the only way to extend this backend. pyproject.toml bounds the version of
# joblib, and tests/sweep/test_cluster.py fails if a new version has changed what is extended here.
from joblib._dask import DaskDistributedBackend

from owtsweep.errors import InputError, require
from owtsweep.sweep.study import Study
from owtsweep.sweep.worker import one_line, tell_other_versions

_Base: Any = DaskDistributedBackend

#: Most seconds to wait for a scheduler's answer, and then for a worker.
PATIENCE_AT_START = 10.0
#: Seconds without a scheduler or any worker after which all remaining tasks count as failed.
PATIENCE = 60.0
_LOOK = 1.0
_NETWORK = ("distributed", "tornado")


@dataclass(frozen=True)
class Lost:
    """The stand-in for the result of a task that the cluster has lost.

    `task` is the number of the task, and `reason` says in one line why the task was lost. `final`
    is True if the whole cluster is lost.
    """

    task: int
    reason: str
    final: bool = False


@contextmanager
def connected(address: str, study: Study, metadata: Mapping[str, str]) -> Iterator[Client]:
    """Yield a connection to the dask cluster at `address`, after checking the cluster's workers.

    `metadata` holds the versions that each worker must have, as `worker.all_versions` returns
    them. `address` is the address of the cluster's scheduler, e.g. tcp://host:8786.

    Raises
    ------
    InputError
        If the scheduler does not answer or has no workers, if a worker cannot load the study or has
        other versions, or if `address` begins with tls:// and dask has no certificates.
    """
    _require_certificates(address)
    try:
        # Connect without a `Client` first: a Client that fails half-way lives on, and ends with a
        # traceback.
        _greet(address)
        client = Client(address, timeout=PATIENCE_AT_START, set_as_default=False)
    except Exception as error:  # whatever listens there may send anything
        raise InputError(
            f"compute.scheduler: no scheduler answers at {address} ({type(error).__name__}); "
            "start one with `dask scheduler`, or use compute.backend=auto"
        ) from error
    loud = _loggers()
    try:
        _check_workers(client, address, study, metadata)
        yield client
    finally:
        _hush()
        try:
            # The scheduler then drops those tasks of this client that no worker has begun.
            client.close(timeout=1.0)
        finally:
            for logger in loud:
                logger.disabled = False


def _greet(address: str) -> None:
    """Connect to the scheduler at `address`, and hang up; raise the error if this fails.

    The error may be of any type, because any program may listen at the address.
    """
    answer: Future[None] = Future()

    async def connect_and_close() -> None:
        arguments = Security().get_connection_args("client")
        try:
            (await connect(address, timeout=PATIENCE_AT_START, **arguments)).abort()
        except Exception as error:
            answer.set_exception(error)
        else:
            answer.set_result(None)

    # In a thread, because a notebook has a loop of its own. Nothing waits for its end: dask may
    # wait for ever for another end that does not speak its language.
    threading.Thread(target=asyncio.run, args=(connect_and_close(),), daemon=True).start()
    answer.result(1.2 * PATIENCE_AT_START)


def _require_certificates(address: str) -> None:
    """Raise InputError if `address` begins with tls:// and dask has no certificates.

    dask itself would notice the missing certificates too late to clean up.
    """
    if address.startswith("tls:"):
        require(
            Security().get_connection_args("client")["ssl_context"] is not None,
            "compute.scheduler: tls:// needs certificates, and dask's configuration names none "
            "(distributed.comm.tls); name them there, or use tcp://",
        )


def _loggers() -> list[logging.Logger]:
    """Return the loggers of dask and of its network library (tornado) that are not disabled."""
    names = [n for n in logging.root.manager.loggerDict if n.split(".")[0] in _NETWORK]
    return [logger for name in names if not (logger := logging.getLogger(name)).disabled]


def _hush() -> None:
    """Silence dask's loggers: closing a connection that is in use would show a traceback."""
    for logger in _loggers():
        logger.disabled = True


def _check_workers(client: Client, address: str, study: Study, metadata: Mapping[str, str]) -> None:
    try:
        client.wait_for_workers(1, timeout=PATIENCE_AT_START)
    except TimeoutError as error:
        raise InputError(
            f"compute.scheduler: {address} has no workers; start some with `dask worker {address}`"
        ) from error
    answers = client.run(tell_other_versions, study, dict(metadata), on_error="return")
    for worker, answer in sorted(answers.items()):
        if isinstance(answer, BaseException):
            answer = (
                f"the worker cannot load the study ({one_line(answer)}); install owtsweep on it"
            )
        if answer:
            raise InputError(f"compute.scheduler: {worker}: {answer}")


class _Calls(Protocol):
    """What joblib submits: calls, each a function with its arguments."""

    items: Sequence[tuple[object, Sequence[int], object]]


class _Callback(Protocol):
    """What joblib calls with a result; `number` is added here."""

    number: int


class Backend(_Base):  # type: ignore[misc]
    """joblib's backend for dask, extended to notice tasks that fail outside their own code.

    joblib 1.6 would wait for ever for a task whose workers died or could not load the task, and for
    a cluster that is gone.
    """

    def __init__(self, client: Client) -> None:
        super().__init__(client=client, pure=False)
        self._last_seen = time.monotonic()

    def effective_n_jobs(self, n_jobs: int = 1) -> int:
        # If one worker is left, joblib would run the tasks itself, in this process. If none is
        # left, joblib would raise at once, but `_watch` waits for a new worker.
        cores: int = sum(self.client.ncores().values())
        return max(2, cores)

    def start_call(self) -> None:
        super().start_call()
        self.client.loop.add_callback(self._watch)

    def submit(self, func: _Calls, callback: _Callback) -> object:
        ((_, arguments, _),) = func.items  # batch_size=1: run_task(work, number, ...)
        callback.number = arguments[1]
        return super().submit(func, callback)

    def abort_everything(self, ensure_ready: bool = True) -> None:
        _hush()  # `connected` turns the loggers on again
        super().abort_everything(ensure_ready)
        # The scheduler then drops tasks that no client waits for and no worker has begun.
        self._callbacks.clear()
        self._results.clear()

    async def _collect(self) -> None:
        while self._continue:
            async for future, result in self.waiting_futures:
                self._last_seen = time.monotonic()
                callback = self._callbacks.pop(future, None)
                waiting = self._results.pop(future, None)
                if callback is None:
                    continue
                if future.status != "finished":
                    error = result[1] if isinstance(result, tuple) else result
                    result = [Lost(callback.number, _short(error))]
                waiting.set_result(result)
                callback(result)
            await asyncio.sleep(0.01)

    async def _watch(self) -> None:
        """Report one task as lost, finally, if there has been no worker for `PATIENCE` seconds."""
        self._last_seen = time.monotonic()
        while self._continue:
            await asyncio.sleep(_LOOK)
            reason = "the cluster has no workers left"
            try:
                if await asyncio.wait_for(self.client.scheduler.ncores(), PATIENCE):
                    self._last_seen = time.monotonic()
            except Exception:  # any error of the network
                reason = "the scheduler does not answer"
            if time.monotonic() - self._last_seen > PATIENCE and self._callbacks and self._continue:
                future, callback = self._callbacks.popitem()
                self._results.pop(future, None)
                callback([Lost(callback.number, reason, final=True)])


def _short(error: object) -> str:
    """Return in one line why dask has lost a task, without dask's advice to read the logs.

    `error` is the exception that dask gives; any other value means that the task was cancelled.
    """
    text = one_line(error) if isinstance(error, BaseException) else "the task was cancelled"
    if "all those workers died" in text:
        return "KilledWorker: every worker that tried it died"
    return text
