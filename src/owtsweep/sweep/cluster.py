"""Computes on other machines: on a dask cluster.

This module is imported on demand, because `dask[distributed]` is an optional dependency and takes
half a second to load.
"""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from itertools import islice

import distributed
from distributed import Client, Security, as_completed
from distributed.core import connect

from owtsweep.errors import InputError, require
from owtsweep.sweep.study import Study
from owtsweep.sweep.worker import TaskResult, one_line, tell_other_versions

#: Most seconds to wait for a scheduler's answer, and then for a worker.
PATIENCE_AT_START = 10.0
#: Seconds without a scheduler or any worker after which all remaining tasks count as failed.
PATIENCE = 60.0
#: Seconds after which the cluster's cores are counted again.
_LOOK = 1.0


@contextmanager
def connected(address: str, study: Study, metadata: Mapping[str, str]) -> Iterator[Client]:
    """Yield a connection to the dask cluster at `address`, after checking the cluster's workers.

    `metadata` holds the versions that each worker must have, as `worker.all_versions` returns
    them. `address` is the address of the cluster's scheduler, e.g. tcp://host:8786.

    Raises InputError if the scheduler does not answer or has no workers, if a worker cannot load
        the study or has other versions, or if `address` begins with tls:// and dask has no
        certificates.
    """
    if address.startswith("tls:"):  # dask itself would notice too late to clean up
        require(
            Security().get_connection_args("client")["ssl_context"] is not None,
            "compute.scheduler: tls:// needs certificates, and dask's configuration names none "
            "(distributed.comm.tls); name them there, or use tcp://",
        )
    try:
        # Connect without a `Client` first: a Client that fails half-way lives on, and ends with a
        # traceback.
        _greet(address)
        # The client tries as long as this to find a lost scheduler again.
        client = Client(address, timeout=max(PATIENCE, PATIENCE_AT_START), set_as_default=False)
    except Exception as error:  # whatever listens there may send anything
        raise InputError(
            f"compute.scheduler: no scheduler answers at {address} ({type(error).__name__}); "
            "start one with `dask scheduler`, or use compute.backend=auto"
        ) from error
    try:
        _check_workers(client, address, study, metadata)
        yield client
    finally:
        with _hushed():
            # The scheduler then drops those tasks of this client that no worker has begun.
            client.close(timeout=1.0)


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


@contextmanager
def _hushed() -> Iterator[None]:
    """Log nothing inside the context.

    Closing a client that looks for a lost scheduler would show a traceback.
    """
    before = logging.root.manager.disable
    logging.disable()
    try:
        yield
    finally:
        logging.disable(before)


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


def run_tasks(
    client: Client, calls: Mapping[int, Callable[[], TaskResult]], at_once: int
) -> Generator[TaskResult]:
    """Run tasks on a cluster, and yield the result of each task as soon as the result arrives.

    Of a task that the cluster loses, the result says so in `lost`. A task that is lost together
    with the connection to the scheduler is sent again, once. Closing the generator cancels the
    tasks that no worker has begun.

    client: the connection to the cluster.
    calls: Number of a task -> the function that runs the task on a worker.
    at_once: How many tasks may be at the cluster at a time; 0: two for each core.
    Raises ConnectionError: After `PATIENCE` seconds without an answer of the scheduler or without
        any worker.
    """
    waiting, sent = dict(calls), dict[distributed.Future, int]()
    sent_again: set[int] = set()
    arriving = as_completed(loop=client.loop, with_results=True, raise_errors=False)
    cores, looked, seen = 0, float("-inf"), time.monotonic()
    try:
        while waiting or sent:
            if time.monotonic() - looked > _LOOK:
                cores, absent = _count_cores(client)
                looked = time.monotonic()
                seen = looked if cores else seen
                if looked - seen > PATIENCE:
                    raise ConnectionError(absent)
            room = (at_once or 2 * max(1, cores)) - len(sent)
            if room > 0 and client.status == "running":
                for number in list(islice(waiting, room)):
                    future = client.submit(waiting.pop(number), pure=False)
                    sent[future] = number
                    arriving.add(future)
            arrived = arriving.next_batch(block=False)
            for future, result in arrived:
                number = sent.pop(future)
                if isinstance(result, TaskResult):
                    seen = time.monotonic()
                    yield result
                elif future.status == "cancelled" and number not in sent_again:
                    sent_again.add(number)
                    waiting[number] = calls[number]
                else:
                    error = result[1] if isinstance(result, tuple) else result
                    yield TaskResult(number, lost=_short(error))
            if not arrived:
                time.sleep(0.01)
    finally:
        for future in sent:
            future.release()


def _count_cores(client: Client) -> tuple[int, str]:
    """Return the number of the cluster's cores, and why it has none."""
    try:
        cores = client.sync(client.scheduler.ncores, callback_timeout=PATIENCE)
    except Exception:  # any error of the network
        return 0, "the scheduler does not answer"
    return sum(cores.values()), "the cluster has no workers left"


def _short(error: BaseException) -> str:
    """Return in one line why dask has lost a task, without dask's advice to read the logs."""
    text = one_line(error)
    if "all those workers died" in text:
        return "KilledWorker: every worker that tried it died"
    return text
