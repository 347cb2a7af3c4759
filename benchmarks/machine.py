"""Measure what this machine can do: memory bandwidth and multiply-add peak, by compiled loops.

The loops run in the same rounds as the kernels of owtsweep, because other programs on the machine
slow down both.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.timing import Time, together

#: Least size of the last cache that is assumed, in bytes.
DEFAULT_CACHE = 32 * 2**20

#: The loop that measures the peak of arithmetic takes REPEATS passes over NUMBERS numbers, and
#: multiplies and adds DEPTH times in each: some 20 ms, about as long as a scheme.
REPEATS, NUMBERS, DEPTH = 20_000, 256, 16


def last_cache() -> int:
    """Return the size in bytes of the first core's largest cache, but at least `DEFAULT_CACHE`."""
    sizes = [DEFAULT_CACHE]
    for path in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        text = path.read_text().strip()
        scale = {"K": 2**10, "M": 2**20}.get(text[-1], 1)
        sizes.append(int(text.rstrip("KM")) * scale)
    return max(sizes)


@cache
def _compiled() -> tuple[Any, Any]:
    from owtsweep.compiled import njit

    @njit
    def triad(a, b, c, factor):
        for i in range(a.shape[0]):
            a[i] = b[i] + factor * c[i]

    @njit
    def multiply_add(values, count, m, s):
        for _ in range(count):
            for i in range(len(values)):
                x = values[i]
                for _ in range(DEPTH):
                    x = x * m + s
                values[i] = x

    return triad, multiply_add


class Limits:
    """The bandwidth (GB/s) and the peak (Gflop/s) of `threads` threads, measured by `now`.

    The bandwidth is that of a = b + s c with three arrays of 4 times the last cache each, 24 bytes
    per element. The peak is that of x = x m + s in registers, multiplied and then added, as the
    kernels of owtsweep do: numba does not fuse the two.
    """

    def __init__(self, threads: int) -> None:
        self.threads = threads
        self.size = 4 * last_cache() // 8
        a, b, c = np.zeros(self.size), np.ones(self.size), np.ones(self.size)
        cuts = np.linspace(0, self.size, threads + 1).astype(int)
        parts = [tuple(x[i:j] for x in (a, b, c)) for i, j in pairwise(cuts)]
        values = [np.full(NUMBERS, 0.5) for _ in range(threads)]
        triad, multiply_add = _compiled()
        self._triad = lambda thread: triad(*parts[thread], 3.0)
        self._multiply_add = lambda thread: multiply_add(values[thread], REPEATS, 0.5, 0.5)

    def now(self, once: Callable[[Callable[[int], object]], Time]) -> dict[str, float]:
        """Measure bandwidth and peak once; `once` is what `timing.together` gives."""
        flops = self.threads * REPEATS * NUMBERS * DEPTH * 2 / 1e9
        return {
            "triad_GB_per_s": 24.0 * self.size / 1e9 / once(self._triad).wall,
            "multiply_add_Gflop_per_s": flops / once(self._multiply_add).wall,
        }


def best(rounds: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return the highest value of each limit over all rounds."""
    return {key: max(one[key] for one in rounds) for key in rounds[0]}


def thread_counts() -> list[int]:
    """Return the numbers of threads to measure with: 1, and the number of cores."""
    return sorted({1, os.cpu_count() or 1})


if __name__ == "__main__":
    for count in thread_counts():
        with together(count) as once:
            limits = Limits(count)
            print(count, best([limits.now(once) for _ in range(15)]))
