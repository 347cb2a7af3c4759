"""Whole studies: time and memory against replicates, duration, amplitudes and workers.

Every point is a process of its own, because a peak of memory never goes down.
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
from typing import Any

from benchmarks.timing import REPEATS, timed

#: What the goal is stated for: the default grid, records of 2000 s, 100 per cell.
WHOLE = ("grid.replicates=100",)
#: Its size, for times per replicate.
REPLICATES = 100
PERIODS = "grid.natural_period=[4.0,7.0]"


def _amplitudes(count: int) -> str:
    """So many amplitudes in steps of a centimetre, as an override's value."""
    return "grid.amplitude=[" + ",".join(f"{0.01 * (i + 1):.2f}" for i in range(count)) + "]"


def axes(scale: float = 1.0) -> dict[str, list[tuple[float, tuple[str, ...]]]]:
    """Axis of growth -> values and overrides of its points, the smallest first.

    `scale` shortens the records, for a quick look.
    """
    # Points near a second: of a third of a second an eighth does not grow.
    base = (PERIODS, "grid.replicates=48", f"record.duration={2000 * scale:g}")
    one = (PERIODS, f"record.duration={2000 * scale:g}", "compute.workers=1")
    durations = [scale * s for s in (500, 1000, 2000, 4000)]
    return {
        "replicates": [(n, (*one, f"grid.replicates={n}")) for n in (16, 32, 64, 128)],
        "duration": [
            (s, (*one[::2], "grid.replicates=32", f"record.duration={s:g}")) for s in durations
        ],
        "amplitudes": [
            (n, (*base, "compute.workers=1", _amplitudes(n))) for n in (10, 100, 1000)
        ],
        # twice as many blocks, so that the last one, which a worker does alone, counts for little
        "workers": [
            (n, (*base[::2], "grid.replicates=96", f"compute.workers={n}"))
            for n in sorted({1, os.cpu_count() or 1})
        ],
    }  # fmt: skip


def measure_whole(repeats: int = REPEATS, overrides: Sequence[str] = WHOLE) -> dict[str, Any]:
    """The study of the goal: medians over processes.

    `process` is the whole process on the clock, interpreter and imports included.
    """
    found = []
    for _ in range(repeats):
        run, time = timed(lambda: _process(overrides, 0))
        found.append({**run, "process": [time.wall]})
    return _medians(found)


def measure_axis(name: str, repeats: int = REPEATS, scale: float = 1.0) -> dict[str, Any]:
    """Points along one axis, and the exponent of the computing alone over it."""
    at = dict(axes(scale)[name])
    runs: dict[float, list[dict[str, list[float]]]] = {value: [] for value in at}
    # There and back, half of the repeats each: a machine that slows down meanwhile tilts no line.
    for value in [*at, *reversed(at)]:
        runs[value].append(_process(at[value], -(-repeats // 2)))
    points = [{"value": value, **_medians(found)} for value, found in runs.items()]
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


def _medians(runs: Sequence[dict[str, list[float]]]) -> dict[str, float]:
    """Of all that some processes measured."""
    return {key: median(value for run in runs for value in run[key]) for key in runs[0]}


def _process(overrides: Sequence[str], repeats: int) -> dict[str, list[float]]:
    root = Path(__file__).resolve().parents[1]
    command = [sys.executable, "-m", "benchmarks.one_study", json.dumps([*overrides])]
    done = subprocess.run(
        [*command, str(repeats)], check=True, stdout=subprocess.PIPE, text=True, cwd=root
    )
    result: dict[str, list[float]] = json.loads(done.stdout.splitlines()[-1])
    return result


if __name__ == "__main__":
    print(measure_whole())
    for axis in axes():
        print(measure_axis(axis, repeats=1))
