"""Where the time of a study goes: core-seconds per default replicate of all six periods, by part.

Each part is run alone on one core for the eight records of a block; what the sweep does per block
besides comes from a whole sweep of such blocks, as what is left.
"""

from __future__ import annotations

from typing import Any

from benchmarks.timing import REPEATS, median_time, samples
from owtsweep.config import compose
from owtsweep.studies.hub import batch
from owtsweep.studies.hub.chain import chain_for_runs
from owtsweep.studies.hub.feed import Feed
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.schemes import resolve

#: Records of a block, periods of the default grid.
BLOCK, PERIODS = 8, 6
SCHEMES = ("EKF", "MKF", "HME1", "HME2")


def measure(repeats: int = REPEATS, duration: float = 2000.0) -> list[dict[str, Any]]:
    """One row per part: core-milliseconds per replicate of the default grid, in the order run.

    A scheme's row is what it adds to its feed: the feed (noise, lanes) is made once for all.
    """
    config: Any = compose([f"record.duration={duration:g}"])
    replicates = list(range(BLOCK))
    records = make_records(config, 4.0, replicates)
    settled = round(config.measures.settling_time / records.sensors.step)
    chains = [chain_for_runs(resolve(s), records.sensors, config, records.steps) for s in SCHEMES]
    lead = max(batch.chunk_of(chain)[1] for chain in chains)

    def feed() -> None:
        made = Feed(records)
        _ = made.fixes
        for _ in made.spans(lead):
            pass

    def seconds(work: Any) -> float:
        return median_time(samples(work, repeats=repeats)).cpu

    spent = {
        "motion (spectrum, inverse FFT)": seconds(lambda: make_records(config, 4.0, replicates))
    }
    spent["sensors (noise, lanes)"] = fed = seconds(feed)
    for name, chain in zip(SCHEMES, chains, strict=True):
        work = lambda c=chain: batch.superposed_sums_of([c], records, settled)  # noqa: E731
        spent[f"{name}: estimate, error sums"] = max(0.0, seconds(work) - fed)
    scale = 1e3 * PERIODS / BLOCK
    return [{"part": part, "ms": scale * value} for part, value in spent.items()]


if __name__ == "__main__":
    for row in measure():
        print(f"{row['part']:32} {row['ms']:8.1f} ms")
