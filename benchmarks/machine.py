"""What this machine can do: memory bandwidth and multiply-add peak, by kernels like ours.

Both are measured with compiled loops on all threads in the same run as the kernels, since what
else runs on the machine slows all of them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.timing import on_threads

#: Taken where the machine does not say how large its last cache is.
DEFAULT_CACHE = 32 * 2**20


def last_cache() -> int:
    """Bytes of the last cache of the first core."""
    sizes = [DEFAULT_CACHE]
    for path in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        text = path.read_text().strip()
        scale = {"K": 2**10, "M": 2**20}.get(text[-1], 1)
        sizes.append(int(text.rstrip("KM")) * scale)
    return max(sizes)


def fastest(work: Callable[[int], Any], threads: int, repeats: int) -> float:
    """Least seconds in which all threads do `work(thread)` once: a peak is what can be reached."""
    return min(time.wall for time in on_threads(work, threads, repeats))


@cache
def _compiled() -> tuple[Any, Any, Any]:
    from llvmlite import ir
    from numba.core import cgutils
    from numba.extending import intrinsic

    from owtsweep.compiled import njit
    from owtsweep.studies.hub.kernels.vector import VECTOR, WIDTH, borrowed, load, store

    @intrinsic
    def fused(typingctx: Any, a: Any, b: Any, c: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            kind = args[0].type.elements[0]
            function = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(kind, [kind] * 3), f"llvm.fma.v{WIDTH}f64"
            )
            parts = [builder.extract_value(value, 0) for value in args]
            return builder.insert_value(args[0], builder.call(function, parts), 0)

        return VECTOR(VECTOR, VECTOR, VECTOR), codegen

    @njit
    def triad(a, b, c, factor):
        for i in range(a.shape[0]):
            a[i] = b[i] + factor * c[i]

    @njit
    def separate(array, count):
        values = borrowed((array,))
        m, s = load(values, 0), load(values, 1)
        a, b, c, d = load(values, 2), load(values, 3), load(values, 4), load(values, 5)
        e, f, g, h = load(values, 6), load(values, 7), load(values, 8), load(values, 9)
        for _ in range(count):
            a, b, c, d = a * m + s, b * m + s, c * m + s, d * m + s
            e, f, g, h = e * m + s, f * m + s, g * m + s, h * m + s
        store(values, 2, a + b + c + d + e + f + g + h)

    @njit
    def contracted(array, count):
        values = borrowed((array,))
        m, s = load(values, 0), load(values, 1)
        a, b, c, d = load(values, 2), load(values, 3), load(values, 4), load(values, 5)
        e, f, g, h = load(values, 6), load(values, 7), load(values, 8), load(values, 9)
        for _ in range(count):
            a, b, c, d = fused(a, m, s), fused(b, m, s), fused(c, m, s), fused(d, m, s)
            e, f, g, h = fused(e, m, s), fused(f, m, s), fused(g, m, s), fused(h, m, s)
        store(values, 2, a + b + c + d + e + f + g + h)

    return triad, separate, contracted


def triad_bandwidth(threads: int, *, repeats: int = 15) -> float:
    """Bytes per second of a = b + s c, three arrays of 4 x the last cache; 24 bytes an element."""
    triad = _compiled()[0]
    size = 4 * last_cache() // 8
    a, b, c = np.zeros(size), np.ones(size), np.ones(size)
    cuts = np.linspace(0, size, threads + 1).astype(int)

    def work(thread: int) -> None:
        part = slice(cuts[thread], cuts[thread + 1])
        triad(a[part], b[part], c[part], 3.0)

    return 24.0 * size / fastest(work, threads, repeats)


def multiply_add_peak(threads: int, *, fused: bool, repeats: int = 15) -> float:
    """Operations per second of x = x m + s in registers, eight chains of eight lanes.

    `fused` contracts the two operations into one instruction, which rounds once. Our kernels keep
    them apart, for the sake of the same bits on every machine.
    """
    loop = _compiled()[2 if fused else 1]
    values = [np.full((10, 8), 0.5) for _ in range(threads)]
    count = 2_000_000
    took = fastest(lambda thread: loop(values[thread], count), threads, repeats)
    return threads * count * 8 * 8 * 2 / took


def machine(threads: Sequence[int] | None = None) -> list[dict[str, float]]:
    """Bandwidth (GB/s) and peaks (Gflop/s) by number of threads: one, and one per core."""
    if threads is None:
        threads = sorted({1, os.cpu_count() or 1})
    return [
        {
            "threads": n,
            "triad_GB_per_s": triad_bandwidth(n) / 1e9,
            "multiply_add_Gflop_per_s": multiply_add_peak(n, fused=False) / 1e9,
            "fused_Gflop_per_s": multiply_add_peak(n, fused=True) / 1e9,
        }
        for n in threads
    ]


if __name__ == "__main__":
    for row in machine():
        print(row)
