"""Whole studies: time and memory against replicates, duration and workers.

Memory is that of a process for each point, because a peak never goes down; the times of an axis are
measured in one, turn about (`benchmarks.turns`).
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from benchmarks.timing import REPEATS, timed

#: What the goal is stated for: the default grid, records of 2000 s, 100 per cell.
WHOLE = ("grid.replicates=100",)
#: What the goal for the memory of long records is stated for.
LONG = (
    "grid.natural_period=[4.0]", "grid.replicates=16", "record.duration=16000", "compute.workers=2",
)  # fmt: skip
#: Of an axis' times.
ROUNDS = 7


class Point(NamedTuple):
    """A study on an axis; `turns`: how many of it take as long as the axis' largest."""

    value: float
    overrides: tuple[str, ...]
    turns: int = 1


def axes(scale: float = 1.0) -> dict[str, list[Point]]:
    """The points of each axis of growth, the smallest first.

    `scale` shortens the records, for a quick look.
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


def measure_whole(repeats: int = REPEATS, overrides: Sequence[str] = WHOLE) -> dict[str, float]:
    """The study of the goal: medians over processes.

    `process` is the whole process on the clock, interpreter and imports included.
    """
    runs = []
    for _ in range(repeats):
        run, time = timed(lambda: _process("one_study", overrides))
        runs.append({**run, "process": time.wall})
    return {key: median(run[key] for run in runs) for key in runs[0]}


def measure_long(overrides: Sequence[str] = LONG) -> float:
    """Peak memory of a study of long records, MB."""
    return float(_process("one_study", overrides)["peak"])


def measure_axis(name: str, rounds: int = ROUNDS, scale: float = 1.0) -> dict[str, Any]:
    """Points along one axis, and the exponent of the computing alone over it."""
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
    """Least-squares slope of log y over log x."""
    x = [math.log(a) for a, _ in points]
    y = [math.log(b) for _, b in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    above = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return above / sum((a - mean_x) ** 2 for a in x) if len(x) > 1 else math.nan


def _process(module: str, what: Any, *words: object) -> Any:
    """What a module of this package prints of something."""
    command = [sys.executable, "-m", f"benchmarks.{module}", json.dumps(what), *map(str, words)]
    root = Path(__file__).resolve().parents[1]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=root)
    return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    print(measure_whole())
    for axis in axes():
        print(measure_axis(axis, rounds=1))
