"""The measured part of docs/scaling.md: how computing grows, and how many cores a study wants.

    python -m benchmarks.scaling           measure and print: a minute or two
    python -m benchmarks.scaling --write   also put the tables into docs/scaling.md

Run it on a quiet machine, after benchmarks.bookkeeping, whose table it reads.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks import STUDY, put
from benchmarks import reference as stepwise
from benchmarks.timing import REPEATS, median_time, timed
from owtsweep.studies import compose, get_study
from owtsweep.sweep.run import sweep

BOOKKEEPING = Path(__file__).with_name("bookkeeping.csv")
#: IMU samples in a second of the default study.
RATE = 100
#: The study whose parts are varied one by one.
BASE = {"replicates": 16, "periods": 2, "duration": 500, "amplitudes": 10}


@dataclass(frozen=True)
class Job:
    """A study of some size: core-seconds of computing, number of blocks, number of tasks."""

    name: str
    seconds: float
    blocks: int
    tasks: int


def seconds(
    replicates: int,
    periods: int,
    duration: float,
    amplitudes: int,
    *,
    workers: int = 1,
    repeats: int = REPEATS,
    wall: bool = False,
) -> float:
    """Measure the median core-seconds of a sweep without figures, or with `wall` the seconds.

    The shards are written. A first sweep, which compiles kernels and computes the gains, does not
    count. `duration` is the length of a record in s.
    """
    overrides = [
        f"grid.replicates={replicates}",
        f"grid.natural_period={[3.0 + 0.5 * i for i in range(periods)]}",
        f"grid.amplitude={[0.05 * (i + 1) for i in range(amplitudes)]}",
        f"record.duration={duration}",
        f"compute.workers={workers}",
        "measures.settling_time=1",
    ]
    times = []
    for _ in range(1 + repeats):
        with tempfile.TemporaryDirectory() as folder:
            config = compose([*STUDY, *overrides, f"results={folder}"])
            outcome, time = timed(lambda config=config: sweep(get_study("hub"), config))
            assert not outcome.failed
            times.append(time)
    return median_time(times[1:]).wall if wall else median_time(times[1:]).cpu


def growth(repeats: int = REPEATS) -> list[dict[str, Any]]:
    """Measure how the time grows with each axis of the study; return one row per axis.

    Each row has the core-seconds of the study `BASE`, those with four times as much along the axis,
    and the exponent of growth.
    """
    base = seconds(**BASE, repeats=repeats)
    rows = []
    for axis in ("replicates", "periods", "duration", "amplitudes"):
        more = seconds(**{**BASE, axis: 4 * BASE[axis]}, repeats=repeats)
        exponent = math.log(more / base) / math.log(4.0)
        rows.append({"axis": axis, "base": base, "more": more, "exponent": exponent})
    return rows


def per_record_second(rows: list[dict[str, Any]]) -> float:
    """Compute the core-seconds per second of record, with all four schemes.

    They follow from what a longer record adds; `rows` are those of `growth`.
    """
    (duration,) = (row for row in rows if row["axis"] == "duration")
    records = BASE["replicates"] * BASE["periods"]
    return (duration["more"] - duration["base"]) / (3 * BASE["duration"] * records)


def jobs(batch: float, reference: float) -> list[Job]:
    """List studies that somebody may want, with their cost.

    `batch` and `reference` are the core-seconds that these engines need per second of record, for
    all four schemes.
    """
    default = 6 * 2000.0
    per_task = 8
    million = 1_000_000
    return [
        Job("default study, 20 replicates", 20 * default * batch, 72, 18),
        Job("the same, 100 replicates", 100 * default * batch, 312, 78),
        Job("the same, 10 000 replicates", 1e4 * default * batch, 30_000, 7500),
        Job("1 million cases of a Python scheme, 0.1 s each", 0.1 * million,
            million // per_task, million // per_task // 10),
        Job("`engine=reference`, 20 replicates", 20 * default * reference, 72, 18),
    ]  # fmt: skip


def bookkeeping() -> dict[str, float]:
    """Read the CPU ms per block of the hub study from bookkeeping.csv, by stage."""
    with BOOKKEEPING.open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["block"].startswith("hub")]
    return {row["stage"]: float(row["cpu_ms"]) for row in rows}


def tables(repeats: int = REPEATS) -> str:
    """Measure, and make the tables of docs/scaling.md in Markdown."""
    rows = growth(repeats)
    batch = per_record_second(rows)
    shared = {**BASE, **{axis: 4 * BASE[axis] for axis in ("replicates", "duration")}}
    one, two = (
        seconds(**shared, workers=workers, wall=True, repeats=repeats) for workers in (1, 2)
    )
    # Motion and noise are run apart, so a step of a record is two of an estimator.
    steps = stepwise.measure(repeats, lead=24, settings=())
    reference = 2.0 * RATE * 1e-9 * sum(row["ns"] for row in steps)
    books = bookkeeping()
    worker = books["write"]
    coordinator = books["sum"] - worker + books["aggregate"]
    lines = [
        f"Base: {BASE['replicates']} replicates, {BASE['periods']} periods, {BASE['duration']} s, "
        f"{BASE['amplitudes']} amplitudes,",
        "four schemes, one worker; core-seconds, shards and tables included.",
        "",
        "| four times as many | base | four times | exponent |",
        "|---|---|---|---|",
        *(
            f"| {row['axis']} | {row['base']:.2f} | {row['more']:.2f} | {row['exponent']:.2f} |"
            for row in rows
        ),
        "",
        f"- One second of record with all four schemes: {1e6 * batch:.0f} µs of one core, so one",
        f"  replicate of the default study {12000 * batch:.2f} core-seconds (*kernels*).",
        f"- The same second with `engine=reference`: {reference:.2f} s, {reference / batch:.0f}",
        "  times as much (*kernels*).",
        f"- Two workers, four times the replicates and the duration: {one / two:.2f} times as fast",
        f"  as one, {two:.1f} s, shards and tables included (*kernels*).",
        f"- Per block: {worker:.2f} ms in the worker that writes it, {coordinator:.2f} ms in the",
        "  one process that plans, checks, reads and aggregates.",
        "",
        "| study | core-hours | coordinator, s | cores for an hour | at most useful |",
        "|---|---|---|---|---|",
    ]
    for job in jobs(batch, reference):
        work = job.seconds + 1e-3 * worker * job.blocks
        serial = 1e-3 * coordinator * job.blocks
        cores = max(1, math.ceil(work / (3600.0 - serial)))
        wanted = f"{cores}" if cores <= job.tasks else f"{cores} (more than it can use)"
        lines.append(f"| {job.name} | {work / 3600:.3g} | {serial:.1f} | {wanted} | {job.tasks} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Measure, print, and with --write change docs/scaling.md; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="put the tables into docs/scaling.md")
    options = parser.parse_args()
    text = tables()
    print(text)
    if options.write:
        put("growth", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
