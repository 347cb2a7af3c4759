"""Run studies of several sizes in turn in this process, and print their times as a line of JSON.

    python -m benchmarks.turns '[[["grid.replicates=2"], 2], [["grid.replicates=4"], 1]]' 5

The machine's speed changes from second to second, by more than an exponent of growth may. So each
round computes all studies, and a small study so often that it takes as long as the large one: the
number after its overrides says how often. The last number is the number of rounds. Gains and
kernels are ready before the clock starts.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from statistics import fmean
from typing import Any

from benchmarks import STUDY
from benchmarks.timing import Time, timed
from owtsweep.io.cache import Kept
from owtsweep.process import keep_freed_memory
from owtsweep.studies import compose, get_study
from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.hub.engines import find_declaration
from owtsweep.studies.hub.schemes import chained
from owtsweep.sweep.run import sweep

#: A study's overrides, and how often a round computes it.
Turns = tuple[Sequence[str], int]


def measure(studies: Sequence[Turns], rounds: int) -> list[dict[str, list[float]]]:
    """Measure the seconds of each study in each round; return lists of one number per round.

    `wall` is the time of a whole sweep: planning, computing, writing and tables. `compute` is the
    core-seconds of computing alone with one thread. `compute_wall` is the time of computing alone
    with all workers, by the clock.
    """
    # Gains of every length stay at hand, as those of the only length do in a sweep.
    chained.CHAINS = Kept(11 * len(studies))
    results: list[dict[str, list[float]]] = [
        {"wall": [], "compute": [], "compute_wall": []} for _ in studies
    ]
    configs = [compose([*STUDY, *overrides]) for overrides, _ in studies]
    for config in configs:
        compute(config, 1)
    most = max(times for _, times in studies)
    for _ in range(rounds):
        taken: list[list[Time]] = [[] for _ in studies]
        for turn in range(most):
            for (_, times), config, done in zip(studies, configs, taken, strict=True):
                if turn * times % most < times:
                    done.append(_computed(config))
        for (overrides, _), done, result in zip(studies, taken, results, strict=True):
            result["compute"].append(fmean(time.cpu for time in done))
            result["compute_wall"].append(fmean(time.wall for time in done))
            result["wall"].append(_whole(overrides))
    return results


def _computed(config: Any) -> Time:
    """Measure computing alone: `cpu` with one thread, and `wall` with all workers."""
    workers = config.compute.workers or 1
    alone = timed(lambda: compute(config, 1))[1]
    if workers == 1:
        return alone
    return alone._replace(wall=timed(lambda: compute(config, workers))[1].wall)


def _whole(overrides: Sequence[str]) -> float:
    with tempfile.TemporaryDirectory() as results:
        config = compose([*STUDY, *overrides, f"results={results}"])
        return timed(lambda: sweep(get_study(config.study), config))[1].wall


def compute(config: Any, threads: int) -> None:
    """Compute all groups of a study's plan on some threads, and discard the results."""
    groups: dict[str, list[Any]] = {}
    blocks = DeclaredBlocks(find_declaration(config))
    for block in blocks.plan(config):
        groups.setdefault(block.group, []).append(block)

    def work(group: list[Any]) -> None:
        for _ in blocks.run(config, group):
            pass

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, groups.values()))


if __name__ == "__main__":
    keep_freed_memory()  # as the command does
    print(json.dumps(measure(json.loads(sys.argv[1]), int(sys.argv[2]))))
