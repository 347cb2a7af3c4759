"""Measure where the time of a study goes: core-milliseconds per replicate, part by part.

A replicate has the six natural periods of the default grid. The parts are measured on one core for
a block of eight records, span by span as a sweep runs them. The bookkeeping of a block (plan,
shards, tables) is not included.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks import STUDY
from benchmarks.timing import REPEATS, median_time, samples
from owtsweep.studies import compose
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import Feed, Records, make_records

#: Records of a block, periods of the default grid.
BLOCK, PERIODS = 8, 6
SCHEMES = ("EKF", "MKF", "HME1", "HME2")


def measure(repeats: int = REPEATS, duration: float = 2000.0) -> list[dict[str, Any]]:
    """Measure core-milliseconds per replicate of the default grid; return one row per part.

    The parts are in the order in which they run. `duration` is the length of a record in s.
    """
    config: Any = compose([*STUDY, f"record.duration={duration:g}"])
    replicates = list(range(BLOCK))
    records = make_records(config, 4.0, replicates)
    settled = round(config.measures.settling_time / records.sensors.step)
    chains = [
        resolve(s).kernel_for_runs(Known(records.sensors, config), records.steps) for s in SCHEMES
    ]
    motion = median_time(
        samples(lambda: make_records(config, 4.0, replicates).motion, repeats=repeats)
    )
    rounds = [_spans(chains, records, settled) for _ in range(1 + repeats)][1:]
    sensors, *schemes = np.median(rounds, axis=0).tolist()
    spent = {
        "motion (spectrum, inverse FFT)": motion.cpu,
        "sensors (noise, lanes)": sensors,
        **{f"{s}: estimate, error sums": t for s, t in zip(SCHEMES, schemes, strict=True)},
    }
    scale = 1e3 * PERIODS / BLOCK
    return [{"part": part, "ms": scale * value} for part, value in spent.items()]


def _spans(chains: Sequence[Chain], records: Records, settled: int) -> list[float]:
    """Measure the core-seconds of the sensors' feed, then of each scheme, for eight records.

    All of them run span by span in turn, as in `batch.sum_errors`.
    """
    _ = records.motion  # made before the clock starts
    started = time.thread_time()
    feed = Feed(records)
    runs = [batch.ChainRun(chain, feed, settled) for chain in chains]
    spent = [0.0] * (1 + len(runs))
    for span in feed.spans(max(run.lead for run in runs)):
        spent[0] += time.thread_time() - started
        for part, run in enumerate(runs, start=1):
            started = time.thread_time()
            run.advance(span)
            spent[part] += time.thread_time() - started
        started = time.thread_time()
    return spent


if __name__ == "__main__":
    for row in measure():
        print(f"{row['part']:32} {row['ms']:8.1f} ms")
