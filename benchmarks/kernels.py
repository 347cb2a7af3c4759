"""How fast the batch kernels are, alone: ns per step and series, and share of the machine's peaks.

A series is a two-axis record (8 states, two lanes), whole, run directly: filter, MHE, smoother,
predictor and error sums, with sensors and truth made before and lying in memory. A thread goes
through its share of the series in one call, so Python is left out. What is counted:

operations (additions, multiplications) per lane and step, as the algorithm needs them
    filter      27, and 9 more at steps with a position: prediction 15, innovation 4 of the specific
                force, correction 8
    smoother    68: window product 32, gain 28, two sums of four
    predictor   18: running sums 6, differences 4, states 8
    MHE         6 for the inputs, 1 more if averaged or sampled, 5 at each tick of T_m, and
                3 (2 (n + 1) + 4 n + 6 with an arrival term) at each fix, n = N_m
per series and step
    error sums  27 with NEES, and 5 where there is an innovation
bytes per series and step that must come from memory at least once
    16 specific force, 16 truth, 16 at each fix, and the gains' rows shared by all series

What the kernels do beyond that is not counted: corrections made a second and third time by the
smoother, its run-up at each chunk, and all traffic to the caches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.machine import machine
from benchmarks.timing import on_threads

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


@dataclass(frozen=True)
class Work:
    """What one scheme has to do per series and step."""

    flops: float
    bytes: float


def work(chain: Any, steps: int, series: int) -> Work:
    """Operations and bytes per series and step by the formula above."""
    M, window = chain.filter.fix_interval, chain.filter.window
    row = chain.gains.row(np.arange(steps))
    applied, fresh = chain.gains.applied[row].mean(), chain.gains.fresh[row].mean()
    lane = 27.0 + 9.0 * applied
    if window:
        lane += 68.0
    if chain.predictor.steps:
        lane += 18.0
    mhe = chain.mhe
    if mhe.active:
        n = mhe.horizon
        at_fix = 3 * (2 * (n + 1) + 4 * n + (6 if mhe.arrival else 0))
        lane += 6.0 + (mhe.inputs != 0) + 5.0 / mhe.interval + at_fix / M
    rows = min(chain.gains.rows, steps)
    gains = rows * (64 + 1 + 24 + 8 + 1 + (256 if window else 0)) / (steps * series)
    return Work(flops=2.0 * lane + 27.0 + 5.0 * fresh, bytes=32.0 + 16.0 / M + gains)


def prepared(scheme: str, series: int, steps: int, tuning: str) -> tuple[Any, Any, Any]:
    """A chain, what it is fed with, and its arrays; sensors and truth are random numbers.

    Fed are specific force (x, y), fixes (x, y), true position and velocity, (tiles, rows, 8) each
    with a tile for every eight series; before the first step there are rows of zeros.
    """
    from owtsweep.arrays import aligned
    from owtsweep.config import compose
    from owtsweep.studies.hub import sensors as sensing
    from owtsweep.studies.hub.batch import arrays_of, chunk_of, weights_of
    from owtsweep.studies.hub.schemes import resolve

    config: Any = compose([f"tuning={tuning}"])
    sensors = sensing.sensors(config.sensors)
    chain = resolve(scheme).kernel(sensors, config, 200_000)  # type: ignore[attr-defined]
    lead = chunk_of(chain)[1]
    fixes = -(-steps // sensors.fix_interval)
    tiles = series // 8
    force, truth = aligned(2, tiles, lead + steps, 8), aligned(2, tiles, lead + steps, 8)
    positions = aligned(2, tiles, fixes, 8)
    draw = np.random.default_rng(1)
    for array in (force, positions, truth):
        array[...] = draw.normal(size=array.shape)
    force[:, :, :lead] = 0.0
    return chain, (*force, *positions, *truth), (arrays_of(chain), weights_of(chain))


@cache
def _driver() -> Any:
    """Compiled: some tiles through `runs.direct`, without Python between them.

    Registers are those that the tile before has left: it does not matter for the time.
    """
    from owtsweep.compiled import njit
    from owtsweep.studies.hub.kernels.runs import direct

    @njit
    def work_through(first, apart, steps, chunk, lead, fed, direction, arrays, weights, registers,
                     scratch, output, sums, squared):  # fmt: skip
        fx, fy, zx, zy, position, velocity = fed
        for tile in range(first, fx.shape[0], apart):
            direct(
                0, steps, chunk, 2000, (fx[tile], fy[tile]), -lead, (zx[tile], zy[tile]),
                position[tile], velocity[tile], direction, arrays, weights, registers, scratch,
                output, sums, squared,
            )  # fmt: skip

    return work_through


def run_scheme(
    scheme: str,
    *,
    threads: int = 1,
    series: int = 256,
    steps: int = 10_000,
    repeats: int = 9,
    tuning: str = "paper",
) -> tuple[list[float], Work]:
    """Seconds per series and step of each repeat, all threads at once, and the work in it."""
    from owtsweep.studies.hub.batch import chunk_of, shared_memory
    from owtsweep.studies.hub.kernels.layout import new_registers

    chain, fed, own = prepared(scheme, series, steps, tuning)
    direction = np.array([0.8, 0.6])
    chunk, lead = chunk_of(chain)
    registers = [new_registers(2, chain.filter.window, chain.mhe.horizon) for _ in range(threads)]
    memory = [shared_memory([chain], 2) for _ in range(threads)]
    squared = np.empty((0, 8))

    driver = _driver()

    def work_through(thread: int) -> None:
        driver(
            thread, threads, steps, chunk, lead, fed, direction, *own, registers[thread],
            *memory[thread], np.zeros((36, 8)), squared,
        )  # fmt: skip

    times = on_threads(work_through, threads, repeats)
    return [t.wall / (steps * series) for t in times], work(chain, steps, series)


def measure(
    *, tuning: str = "paper", series: int = 256, repeats: int = 9, steps: int = 10_000
) -> list[dict[str, Any]]:
    """One row per scheme and number of threads; `share` is the roofline's time over our median.

    The roofline is max(bytes / triad, operations / multiply-add peak) on as many threads, with the
    higher of the two peaks, fused or not. ns_cached is the median for so few series that all they
    are fed with stays in the last cache.
    """
    peaks = {int(row["threads"]): row for row in machine()}
    rows = []
    for scheme in SCHEMES:
        for threads, peak in peaks.items():
            times, needs = run_scheme(
                scheme, threads=threads, series=series, steps=steps, repeats=repeats, tuning=tuning
            )
            near, _ = run_scheme(
                scheme,
                threads=threads,
                series=8 * threads,
                steps=steps,
                repeats=4 * repeats,
                tuning=tuning,
            )
            memory = needs.bytes / peak["triad_GB_per_s"]
            arithmetic = needs.flops / max(
                peak["multiply_add_Gflop_per_s"], peak["fused_Gflop_per_s"]
            )
            middle = 1e9 * float(np.median(times))
            rows.append(
                {
                    "scheme": scheme, "tuning": tuning, "threads": threads, "series": series,
                    "ns_least": 1e9 * min(times), "ns_median": middle,
                    "ns_cached": 1e9 * float(np.median(near)),
                    "flops": float(needs.flops), "bytes": float(needs.bytes),
                    "ns_memory": float(memory), "ns_arithmetic": float(arithmetic),
                    "share": float(max(memory, arithmetic)) / middle,
                    **peak,
                }
            )  # fmt: skip
    return rows


def reasons(rows: Sequence[dict[str, Any]], goal: float = 0.6) -> list[str]:
    """What the schemes that miss the goal lose, one line each; empty where all meet it."""
    lines = []
    for row in rows:
        if row["share"] >= goal:
            continue
        fetching = max(row["ns_median"] - row["ns_cached"], 0.0)
        rest = row["ns_median"] - fetching - row["ns_arithmetic"]
        lines.append(
            f"{row['scheme']}, {row['threads']} threads: share {row['share']:.2f}. Of "
            f"{row['ns_median']:.2f} ns, {fetching:.2f} are the difference to data in the last "
            "cache (the roofline lets all of memory's time pass behind the arithmetic), "
            f"{row['ns_arithmetic']:.2f} the counted operations at the machine's peak, and "
            f"{rest:.2f} the rest, which is not told apart: waiting for operations and caches, "
            "gains, operations done again, calls from Python."
        )
    return lines


if __name__ == "__main__":
    measured = measure()
    for row in measured:
        print(
            "{scheme:5} {threads} threads: {ns_least:6.2f} ns (median {ns_median:.2f}, "
            "in cache {ns_cached:.2f}), "
            "{flops:.0f} flops, {bytes:.1f} bytes, memory {ns_memory:.2f} ns, arithmetic "
            "{ns_arithmetic:.2f} ns, share {share:.2f}; triad {triad_GB_per_s:.1f} GB/s, peak "
            "{multiply_add_Gflop_per_s:.1f} (fused {fused_Gflop_per_s:.1f}) Gflop/s".format(**row)
        )
    print(*reasons(measured), sep="\n")
