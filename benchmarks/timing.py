"""How every benchmark measures time."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median

REPEATS = 5


def seconds(work: Callable[[], object], *, repeats: int = REPEATS, warm: int = 1) -> float:
    """Median wall time of `work` over so many repeats, s, after `warm` runs that do not count."""
    for _ in range(warm):
        work()
    taken = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        taken.append(time.perf_counter() - began)
    return median(taken)
