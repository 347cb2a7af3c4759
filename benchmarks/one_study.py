"""One study in this process, without figures; prints one line of JSON.

    python -m benchmarks.one_study '["grid.replicates=2"]' 5

The number says how often it is measured. With 0 the sweep runs once, in a process that has made no
gains and loaded no kernels before; else gains and kernels are there when the clock starts.
"""

from __future__ import annotations

import json
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from benchmarks.scale import peak_megabytes
from benchmarks.timing import samples, timed
from owtsweep.config import compose
from owtsweep.memory import keep_freed_memory
from owtsweep.studies import get_study
from owtsweep.sweep.run import Outcome, sweep


def run(overrides: list[str], repeats: int) -> dict[str, list[float]]:
    """Seconds (each time's), peak memory of the process (10^6 bytes), bytes of all shards, cases.

    `wall` is planning, computing, writing and tables; `compute` the core-seconds of computing
    alone, with one thread; `compute_wall` the same on the clock with all workers.
    """
    with tempfile.TemporaryDirectory() as results:
        names = iter(range(1000))

        def whole(*more: str) -> Outcome:
            name = f"name=run-{next(names)}"
            config = compose([*overrides, f"results={results}", name, *more])
            return sweep(get_study(config.study), config)

        if repeats:
            whole("grid.replicates=1", "grid.natural_period=[4.0]")
        outcome, first = timed(whole)
        times = [first, *samples(whole, repeats=repeats - 1, warm=0)] if repeats else [first]
        peak = peak_megabytes()
        shards = (outcome.run.folder / "cases").glob("*.parquet")
        found = {
            "wall": [time.wall for time in times],
            "peak": [float(peak)],
            "bytes": [float(sum(path.stat().st_size for path in shards))],
            "cases": [float(outcome.computed)],
        }
    if repeats:
        config = compose(overrides)
        workers = getattr(config.compute, "workers", None) or 1
        alone = samples(lambda: compute(config, 1), repeats=repeats, warm=0)
        found["compute"] = [time.cpu for time in alone]
        if workers > 1:
            alone = samples(lambda: compute(config, workers), repeats=repeats, warm=0)
        found["compute_wall"] = [time.wall for time in alone]
    return found


def compute(config: Any, threads: int) -> None:
    """All groups of a study's plan, computed and thrown away."""
    from owtsweep.studies.hub import blocks

    groups: dict[str, list[Any]] = {}
    for block in blocks.plan(config):
        groups.setdefault(block.group, []).append(block)

    def work(group: list[Any]) -> None:
        for _ in blocks.run(config, group):
            pass

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, groups.values()))


if __name__ == "__main__":
    keep_freed_memory()  # as the command does
    print(json.dumps(run(json.loads(sys.argv[1]), int(sys.argv[2]))))
