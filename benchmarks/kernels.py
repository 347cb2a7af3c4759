"""Measure the batch kernels alone: ns per step and series, and share of the machine's peaks.

A series is a whole two-axis record (8 states, two lanes). The kernels run filter, MHE, smoother,
predictor and error sums; sensors and truth are made before and lie in memory. The threads take
eight series in turn. Each thread works in a single call, so Python takes no time. Counted are:

operations (additions, multiplications) per lane and step, as the algorithm needs them
    filter      27, and 9 more at steps with a position: prediction 15, innovation 4 of the specific
                force, correction 8
    smoother    44: what leaves the window 8, gain 28, two sums of four; 8 more where a position
                leaves the window
    predictor   17: moving sums 9, states 8
    MHE         6 for the inputs, 1 more if averaged or sampled, 5 at each tick of T_m, and
                3 (2 (n + 1) + 4 n + 6 with an arrival term) at each fix, n = N_m
per series and step
    error sums  27 with NEES, and 5 where there is an innovation
bytes per series and step that must come from memory at least once
    16 specific force, 16 truth, 16 at each fix, and the gains' rows shared by all series

Other work of the kernels is not counted: corrections that the smoother makes a second time, the
smoother's run-up at each chunk, and all traffic to the caches.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks import STUDY
from benchmarks.machine import Limits, best, thread_counts
from benchmarks.timing import together

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
#: Least share of the machine's limit that the kernels must reach.
SHARE = 0.5
#: How often all series are run in one measurement. This takes 10 to 30 ms on two cores; waking the
#: last thread and noticing its end takes 0.2 ms.
PASSES = 3


@dataclass(frozen=True)
class Work:
    """The operations and the bytes that one scheme needs per series and step."""

    flops: float
    bytes: float

    def limits(self, peaks: dict[str, float]) -> tuple[float, float]:
        """Return the least time that memory and that arithmetic need, in ns per series and step.

        `peaks` are the results of `machine.Limits.now`.
        """
        peak = peaks["multiply_add_Gflop_per_s"]
        return self.bytes / peaks["triad_GB_per_s"], self.flops / peak


def work(chain: Any, steps: int, series: int) -> Work:
    """Count operations and bytes per series and step, as the docstring of this module says.

    `chain` is the scheme in its form for the batch engine.
    """
    M, window = chain.filter.fix_interval, chain.filter.window
    row = chain.gains.row(np.arange(steps))
    applied, fresh = chain.gains.applied[row].mean(), chain.gains.fresh[row].mean()
    lane = 27.0 + 9.0 * applied
    if window:
        lane += 44.0 + 8.0 * applied
    if chain.predictor.steps:
        lane += 17.0
    mhe = chain.mhe
    if mhe.active:
        n = mhe.horizon
        at_fix = 3 * (2 * (n + 1) + 4 * n + (6 if mhe.arrival else 0))
        lane += 6.0 + (mhe.inputs != 0) + 5.0 / mhe.interval + at_fix / M
    rows = min(chain.gains.rows, steps)
    gains = rows * (64 + 1 + 24 + 8 + 1 + (192 if window else 0)) / (steps * series)
    return Work(flops=2.0 * lane + 27.0 + 5.0 * fresh, bytes=32.0 + 16.0 / M + gains)


def prepared(scheme: str, series: int, steps: int, tuning: str) -> tuple[Any, Any, Any]:
    """Prepare a scheme for `series` series of `steps` steps, with random sensors and truth.

    Returns the scheme's chain (its form for the batch engine), the inputs, and the chain's arrays
    and weights. The inputs are specific force and fixes (x, then y), and the truth, of shape
    (tiles, rows, 16) each, with a tile for every eight series. Before the first step, specific
    force is zero for some rows.
    """
    from owtsweep.arrays import aligned
    from owtsweep.studies import compose
    from owtsweep.studies.hub import sensors as sensing
    from owtsweep.studies.hub.batch import arrays_of, chunk_of, weights_of
    from owtsweep.studies.hub.contract import Known, resolve

    config: Any = compose([STUDY[0], f"tuning={tuning}"])
    sensors = sensing.sensors(config.sensors)
    chain = resolve(scheme).kernel(Known(sensors, config), 200_000)
    lead, fixes, tiles = chunk_of(chain)[1], -(-steps // sensors.fix_interval), series // 8
    inputs = tuple(aligned(tiles, rows, 16) for rows in (lead + steps, fixes, lead + steps))
    draw = np.random.default_rng(1)
    for array in inputs:
        array[...] = draw.normal(size=array.shape)
    inputs[0][:, :lead] = 0.0
    return chain, inputs, (arrays_of(chain), weights_of(chain))


@cache
def _driver() -> Any:
    """Compile the function that runs tiles through `kernels.chain.run` without Python between them.

    Each tile starts with the memory that the previous tile left; the time does not depend on its
    values.
    """
    from owtsweep.compiled import njit
    from owtsweep.studies.hub.kernels.chain import run
    from owtsweep.studies.hub.kernels.layout import Fed, Truth

    @njit
    def work_through(first, stop, every, stretch, series, chain, memory, sums, squared):
        force, fixes, motion, direction, lead = series
        arrays, weights = chain
        for turn in range(first, stop, every):
            tile = turn % force.shape[0]
            fed, truth = Fed(force[tile], -lead, fixes[tile]), Truth(motion[tile], direction)
            run(stretch, fed, truth, arrays, weights, memory, sums, squared)

    return work_through


class Job:
    """One scheme's work on `series` series of `steps` steps, shared by `threads` threads.

    A call with the number of a thread does this thread's part of running all series `PASSES` times.
    Only `different` series are made and run repeatedly; with 0, all are made.
    """

    def __init__(
        self, scheme: str, threads: int, series: int, steps: int, tuning: str, different: int = 0
    ) -> None:
        from owtsweep.studies.hub.batch import chunk_of, new_memory, new_sums

        self.chain, fed, self.arrays = prepared(scheme, different or series, steps, tuning)
        self.threads, self.series, self.steps = threads, series, steps
        chunk, lead = chunk_of(self.chain)
        self.stretch = (0, steps, chunk, 2000)
        self.fed = (*fed, np.array([0.8, 0.6]), lead)
        self.memory = [new_memory(self.arrays[0], 16, chunk) for _ in range(threads)]
        self.totals = [(new_sums(16), np.empty((0, 8))) for _ in range(threads)]
        self.work = work(self.chain, steps, series)

    def __call__(self, thread: int) -> None:
        _driver()(
            thread, PASSES * self.series // 8, self.threads, self.stretch, self.fed, self.arrays,
            self.memory[thread], *self.totals[thread],
        )  # fmt: skip

    def each(self, seconds: float) -> float:
        """Convert seconds for all passes to ns per step and series."""
        return 1e9 * seconds / (PASSES * self.steps * self.series)


def measure(
    *, tuning: str = "paper", series: int = 256, repeats: int = 15, steps: int = 10_000
) -> list[dict[str, Any]]:
    """Measure all schemes in rounds; return one row per scheme and number of threads.

    Each round runs every scheme once and measures the machine's limits too, because other programs
    change these limits from one second to the next. The limit of a scheme is the least time it
    needs, max(bytes / triad bandwidth, operations / multiply-add peak). `share` is the median over
    the rounds of limit / time; `share_of_best` is the limit by the highest peaks of all rounds,
    divided by the median time. `ns_cached` is the median time for so few series that all inputs
    stay in the last cache.
    """
    rows = [
        row
        for threads in thread_counts()
        for row in _on(threads, tuning=tuning, series=series, repeats=repeats, steps=steps)
    ]
    return sorted(rows, key=lambda row: SCHEMES.index(row["scheme"]))


def _on(
    threads: int, *, tuning: str, series: int, repeats: int, steps: int
) -> Iterator[dict[str, Any]]:
    jobs = {scheme: Job(scheme, threads, series, steps, tuning) for scheme in SCHEMES}
    near = {scheme: Job(scheme, threads, series, steps, tuning, 8 * threads) for scheme in SCHEMES}
    times: dict[str, list[float]] = {scheme: [] for scheme in SCHEMES}
    cached: dict[str, list[float]] = {scheme: [] for scheme in SCHEMES}
    limits, rounds = Limits(threads), []
    with together(threads) as once:
        for turn in range(1 + repeats):
            rounds.append(limits.now(once))
            for scheme in SCHEMES:
                times[scheme].append(jobs[scheme].each(once(jobs[scheme]).wall))
                cached[scheme].append(near[scheme].each(once(near[scheme]).wall))
            if turn == 0:  # a warm-up
                for before in (rounds, *times.values(), *cached.values()):
                    before.clear()
    peaks = best(rounds)
    for scheme in SCHEMES:
        needs = jobs[scheme].work
        memory, arithmetic = needs.limits(peaks)
        shares = [
            max(needs.limits(then)) / took for then, took in zip(rounds, times[scheme], strict=True)
        ]
        middle = float(np.median(times[scheme]))
        yield {
            "scheme": scheme, "tuning": tuning, "threads": threads, "series": series,
            "ns_least": min(times[scheme]), "ns_median": middle,
            "ns_cached": float(np.median(cached[scheme])),
            "flops": float(needs.flops), "bytes": float(needs.bytes),
            "ns_memory": memory, "ns_arithmetic": arithmetic,
            "share": float(np.median(shares)), "share_of_best": max(memory, arithmetic) / middle,
            **peaks,
        }  # fmt: skip


def tell_loss(row: dict[str, Any]) -> str:
    """Say in one line where a scheme loses time; `row` is one of `measure`."""
    fetching = max(row["ns_median"] - row["ns_cached"], 0.0)
    rest = row["ns_median"] - fetching - row["ns_arithmetic"]
    return (
        f"{row['scheme']}, {row['threads']} threads: share {row['share']:.2f}. Of "
        f"{row['ns_median']:.2f} ns, {fetching:.2f} are the difference to data in the last "
        "cache (the roofline lets all of memory's time pass behind the arithmetic), "
        f"{row['ns_arithmetic']:.2f} the counted operations at the machine's peak, and "
        f"{rest:.2f} the rest, which is not told apart: waiting for operations and caches, "
        "gains, operations done again, calls from Python."
    )


if __name__ == "__main__":
    measured = measure()
    for row in measured:
        print(
            "{scheme:5} {threads} threads: {ns_least:6.2f} ns (median {ns_median:.2f}, "
            "in cache {ns_cached:.2f}), "
            "{flops:.0f} flops, {bytes:.1f} bytes, memory {ns_memory:.2f} ns, arithmetic "
            "{ns_arithmetic:.2f} ns, share {share:.2f}; triad {triad_GB_per_s:.1f} GB/s, peak "
            "{multiply_add_Gflop_per_s:.1f} Gflop/s; of the best "
            "limit {share_of_best:.2f}".format(**row)
        )
    print(*(tell_loss(row) for row in measured if row["share"] < SHARE), sep="\n")
