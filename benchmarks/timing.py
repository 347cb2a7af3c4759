"""Measure time, as every benchmark does: several times after a warm-up; the median counts."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from statistics import median
from typing import NamedTuple, TypeVar

T = TypeVar("T")
REPEATS = 5


class Time(NamedTuple):
    """A time in seconds: by the clock (`wall`), and of all cores of this process together (`cpu`).

    `cpu` leaves out waiting for the disk and for other programs.
    """

    wall: float
    cpu: float


def timed(work: Callable[[], T]) -> tuple[T, Time]:
    """Call `work`; return its result and the time that it took."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, Time(time.perf_counter() - wall, time.process_time() - cpu)


def samples(work: Callable[[], object], *, repeats: int = REPEATS, warm: int = 1) -> list[Time]:
    """Call `work` `repeats` times, after `warm` calls that do not count; return the times."""
    for _ in range(warm):
        work()
    return [timed(work)[1] for _ in range(repeats)]


@contextmanager
def together(threads: int) -> Iterator[Callable[[Callable[[int], object]], Time]]:
    """Give a function that measures the time of `work(thread)` on several threads at once.

    The clock stops when the last thread has finished.
    """
    with ThreadPoolExecutor(threads) as pool:
        yield lambda work: timed(lambda: list(pool.map(work, range(threads))))[1]


def seconds(work: Callable[[], object], *, repeats: int = REPEATS, warm: int = 1) -> float:
    """Measure the median wall time of `work` in s."""
    return median_time(samples(work, repeats=repeats, warm=warm)).wall


def median_time(times: list[Time]) -> Time:
    """Return the median wall time and the median CPU time."""
    return Time(*(median(values) for values in zip(*times, strict=True)))
