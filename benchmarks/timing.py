"""How every benchmark measures time: after a warm-up, several times; the median counts."""

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
    """Seconds: on the clock, and of all this process's cores together.

    `cpu` leaves out waiting: for the disk, or for a busy machine's other work.
    """

    wall: float
    cpu: float


def timed(work: Callable[[], T]) -> tuple[T, Time]:
    """What `work` gives, and what it took."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, Time(time.perf_counter() - wall, time.process_time() - cpu)


def samples(work: Callable[[], object], *, repeats: int = REPEATS, warm: int = 1) -> list[Time]:
    """What `work` took each time, after `warm` runs that do not count."""
    for _ in range(warm):
        work()
    return [timed(work)[1] for _ in range(repeats)]


@contextmanager
def together(threads: int) -> Iterator[Callable[[Callable[[int], object]], Time]]:
    """What times `work(thread)` on so many threads at once, the last one ending the clock."""
    with ThreadPoolExecutor(threads) as pool:
        yield lambda work: timed(lambda: list(pool.map(work, range(threads))))[1]


def seconds(work: Callable[[], object], *, repeats: int = REPEATS, warm: int = 1) -> float:
    """Median wall time of `work`, s."""
    return median_time(samples(work, repeats=repeats, warm=warm)).wall


def median_time(times: list[Time]) -> Time:
    """The medians of both."""
    return Time(*(median(values) for values in zip(*times, strict=True)))
