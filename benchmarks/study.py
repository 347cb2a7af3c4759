"""Measure whole studies: time and memory against replicates, duration and workers.

The goal is stated for the default grid, with records of 2000 s, 100 per cell.

The memory of each study is measured in a process of its own, because a peak never goes down. The
times of all studies along an axis are measured in one process, in turn (`benchmarks.turns`).
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from statistics import linear_regression, median
from typing import Any, NamedTuple

from benchmarks import ROOT
from benchmarks.timing import REPEATS, timed

#: The study for which the goal for the memory of long records is stated.
LONG = (
    "grid.natural_period=[4.0]", "grid.replicates=16", "record.duration=16000", "compute.workers=2",
)  # fmt: skip
#: Number of rounds in which the times along an axis are measured.
ROUNDS = 7


class Point(NamedTuple):
    """A study on an axis; `turns` such studies take about as long as the largest on the axis."""

    value: float
    overrides: tuple[str, ...]
    turns: int = 1


def axes(scale: float = 1.0) -> dict[str, list[Point]]:
    """Return the studies along each axis of growth, the smallest first.

    A `scale` below 1 shortens the records, for a quick look.
    """
    duration = f"record.duration={2000 * scale:g}"
    alone = ("grid.natural_period=[4.0]", "compute.workers=1")
    base = ("grid.natural_period=[4.0,7.0]", duration)
    return {
        "replicates": [
            Point(n, (*alone, duration, f"grid.replicates={n}"), 128 // n)
            for n in (16, 32, 64, 128)
        ],
        # a quarter of the default length to four times as much
        "duration": [
            Point(scale * s, (*alone, "grid.replicates=16", f"record.duration={scale * s:g}"),
                  8000 // s)
            for s in (500, 1000, 2000, 4000, 8000)
        ],
        # so many blocks that the last one, which a worker does alone, counts for little
        "workers": [
            Point(n, (*base, "grid.replicates=96", f"compute.workers={n}"))
            for n in sorted({1, os.cpu_count() or 1})
        ],
    }  # fmt: skip


def measure(
    replicates: int = 100,
    repeats: int = REPEATS,
    rounds: int = ROUNDS,
    *,
    scale: float = 1.0,
    along: Sequence[str] = ("replicates", "duration", "workers"),
) -> dict[str, Any]:
    """Measure the whole study, the growth along some axes and, in full length, long records.

    A `scale` below 1 shortens the records, and leaves out the long ones, whose peak memory is
    measured in MB.
    """
    whole = (f"grid.replicates={replicates}", f"record.duration={2000 * scale:g}")
    results: dict[str, Any] = {
        "replicates": replicates,
        "whole": measure_whole(repeats, whole),
        "axes": [measure_axis(name, rounds, scale) for name in along],
    }
    if scale == 1.0:
        results["long"] = _process("one_study", LONG)["peak"]
    return results


def measure_whole(repeats: int, overrides: Sequence[str]) -> dict[str, float]:
    """Run a study in several processes; return the medians.

    They are those of `one_study.run`, and `process`: the seconds of the whole process, with the
    start of the interpreter and imports.
    """
    runs = []
    for _ in range(repeats):
        run, time = timed(lambda: _process("one_study", overrides))
        runs.append({**run, "process": time.wall})
    return {key: median(run[key] for run in runs) for key in runs[0]}


def measure_axis(name: str, rounds: int = ROUNDS, scale: float = 1.0) -> dict[str, Any]:
    """Measure the studies along one axis; return the points and the exponent of growth.

    The exponent is that of the computing alone.
    """
    on = axes(scale)[name]
    times = _process("turns", [(point.overrides, point.turns) for point in on], rounds)
    points = [
        {
            "value": point.value,
            **_process("one_study", point.overrides),  # memory and shards
            **{key: median(seconds) for key, seconds in seconds_of.items()},
        }
        for point, seconds_of in zip(on, times, strict=True)
    ]
    key = "compute_wall" if name == "workers" else "compute"
    return {
        "axis": name,
        "points": points,
        "exponent": slope([(point["value"], point[key]) for point in points]),
    }


def slope(points: Sequence[tuple[float, float]]) -> float:
    """Compute the least-squares slope of log y against log x; `points` are pairs (x, y)."""
    x = [math.log(a) for a, _ in points]
    y = [math.log(b) for _, b in points]
    return linear_regression(x, y).slope if len(points) > 1 else math.nan


def _process(module: str, what: Any, *words: object) -> Any:
    """Run a module of this package in a new process; return the JSON in its last printed line.

    `what` is the first argument on the module's command line, in JSON; `words` are the others.
    """
    command = [sys.executable, "-m", f"benchmarks.{module}", json.dumps(what), *map(str, words)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    print(measure(rounds=1))
