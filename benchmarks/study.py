"""Whole studies: wall time and memory against replicates, duration, amplitudes and workers.

Every point is a process of its own, because a peak of memory never goes down.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any


def _amplitudes(count: int) -> str:
    """So many amplitudes in steps of a centimetre, as an override's value."""
    return "[" + ",".join(f"{0.01 * (i + 1):.2f}" for i in range(count)) + "]"


#: What the goal is stated for: the default grid with 100 records per cell.
WHOLE = ("grid.replicates=100",)
SMALL = ("grid.natural_period=[4.0,7.0]", "record.duration=500")
#: Axis of growth -> the overrides of its points. The first of each is the smallest.
AXES: dict[str, list[tuple[float, tuple[str, ...]]]] = {
    "replicates": [(n, (*SMALL, f"grid.replicates={n}")) for n in (16, 32, 64, 128, 256)],
    "duration": [
        (s, ("grid.natural_period=[4.0,7.0]", "grid.replicates=16", f"record.duration={s}"))
        for s in (500, 1000, 2000, 4000, 8000)
    ],
    "amplitudes": [
        (n, ("grid.replicates=16", f"grid.amplitude={_amplitudes(n)}")) for n in (10, 100, 1000)
    ],
    "workers": [(n, ("grid.replicates=32", f"compute.workers={n}")) for n in (1, 2)],
}


def measure_whole(repeats: int = 5, overrides: Sequence[str] = WHOLE) -> dict[str, Any]:
    """The study of the goal: medians of wall time (s) and of peak memory (bytes) over processes."""
    runs = [_process(overrides, warm=False) for _ in range(repeats)]
    return {key: median(run[key] for run in runs) for key in runs[0]}


def measure_axis(name: str, repeats: int = 5) -> dict[str, Any]:
    """Points along one axis, and the exponent of the compute time over it.

    Compute time is the sweep's own, in a process that has computed the gains before: they are made
    once per tuning and length, whatever the size of the study.
    """
    points = []
    for value, overrides in AXES[name]:
        runs = [_process(overrides, warm=True) for _ in range(repeats)]
        points.append({"value": value} | {key: median(run[key] for run in runs) for key in runs[0]})
    return {
        "axis": name,
        "points": points,
        "exponent": slope([(p["value"], p["compute"]) for p in points]),
    }


def slope(points: Sequence[tuple[float, float]]) -> float:
    """Least-squares slope of log y over log x."""
    x = [math.log(a) for a, _ in points]
    y = [math.log(b) for _, b in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    above = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return above / sum((a - mean_x) ** 2 for a in x)


def _process(overrides: Sequence[str], *, warm: bool) -> dict[str, float]:
    root = Path(__file__).resolve().parents[1]
    command = [sys.executable, "-m", "benchmarks.one_study", json.dumps([*overrides]), str(warm)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=root)
    result: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return result


if __name__ == "__main__":
    print(measure_whole())
    for axis in AXES:
        print(measure_axis(axis, repeats=1))
