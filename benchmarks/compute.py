"""What computing costs per group of blocks, without store and aggregation, in CPU seconds.

How it grows with replicates, duration, amplitudes and threads. Chains (gains) are made before the
clock starts: they are made once per run, `setup` says what they cost.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np


def config_of(*overrides: str) -> Any:
    """The default study at one natural period, with overrides."""
    from owtsweep.config import compose

    return compose(["grid.natural_period=[4.0]", *overrides])


def compute(config: Any, threads: int = 1) -> tuple[float, float]:
    """Wall and CPU seconds in which that many threads compute all groups of a study's plan."""
    from owtsweep.studies.hub import blocks

    groups: dict[str, list[Any]] = {}
    for block in blocks.plan(config):
        groups.setdefault(block.group, []).append(block)

    def work(group: list[Any]) -> None:
        for _ in blocks.run(config, group):
            pass

    with ThreadPoolExecutor(threads) as pool:
        wall, cpu = time.perf_counter(), time.process_time()
        list(pool.map(work, groups.values()))
        return time.perf_counter() - wall, time.process_time() - cpu


def setup(config: Any) -> float:
    """CPU seconds to make the chains of all schemes, which a run does once."""
    from owtsweep.studies.hub import chain, sensors
    from owtsweep.studies.hub.schemes import resolve

    chain._CHAINS.clear()
    known = sensors.sensors(config.sensors)
    steps = round(config.record.duration / known.step)
    began = time.process_time()
    for scheme in config.schemes:
        chain.chain_for_runs(resolve(scheme), known, config, steps)
    return time.process_time() - began


def _measured(config: Any, repeats: int, threads: int = 1) -> dict[str, float]:
    made = setup(config)
    compute(config, threads)
    times = np.array([compute(config, threads) for _ in range(repeats)])
    wall, cpu = np.median(times, axis=0)
    return {
        "wall_s": float(wall), "cpu_s": float(cpu), "cpu_least_s": float(times[:, 1].min()),
        "setup_s": made,
    }  # fmt: skip


def growth(what: str, values: Sequence[int], *, repeats: int = 5) -> list[dict[str, Any]]:
    """Seconds by `replicates`, `duration` (s) or number of `amplitudes`."""
    rows = []
    for value in values:
        overrides = {
            "replicates": [f"grid.replicates={value}", "record.duration=500"],
            "duration": ["grid.replicates=8", f"record.duration={value}"],
            "amplitudes": [
                "grid.replicates=16",
                "record.duration=1000",
                f"grid.amplitude=[{','.join(f'{0.05 + 0.01 * i:g}' for i in range(value))}]",
            ],
        }[what]
        rows.append({"what": what, "value": value, **_measured(config_of(*overrides), repeats)})
    return rows


def exponent(rows: Sequence[dict[str, Any]], seconds: str = "cpu_least_s") -> float:
    """Slope of log seconds over log value."""
    x, y = (np.log([row[name] for row in rows]) for name in ("value", seconds))
    return float(np.polyfit(x, y, 1)[0])


def speedup(*, replicates: int = 64, repeats: int = 5) -> dict[str, float]:
    """How many times faster two threads compute than one, by wall time."""
    config = config_of(f"grid.replicates={replicates}")
    one, two = (_measured(config, repeats, threads) for threads in (1, 2))
    return {"one_s": one["wall_s"], "two_s": two["wall_s"], "ratio": one["wall_s"] / two["wall_s"]}


if __name__ == "__main__":
    for what, values in (
        ("replicates", (8, 16, 32, 64)),
        ("duration", (500, 1000, 2000, 4000)),
        ("amplitudes", (10, 100, 1000)),
    ):
        found = growth(what, values)
        for row in found:
            print(row)
        print(f"{what}: exponent {exponent(found):.3f}")
    print("two threads against one:", speedup())
