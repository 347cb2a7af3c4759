"""What a block costs besides its computing: plan, key, status, write, read; and whole large plans.

    python -m benchmarks.bookkeeping           per block, medians of 5: some seconds
    python -m benchmarks.bookkeeping --large   also a million cases and 10 000 replicates: minutes

Writes benchmarks/bookkeeping.csv; with --write also the tables of docs/scaling.md. The goal:
planning and bookkeeping under 2 ms per block.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks import ROOT, STUDY, put
from benchmarks.bulk_study import BulkStudy, bulk_config
from benchmarks.scale import made_up_rows
from benchmarks.timing import REPEATS, median_time, timed
from owtsweep.io.tables import write_table
from owtsweep.studies import compose, get_study
from owtsweep.sweep.plan import make_plan
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.store import encode

BLOCKS = 240
GOAL_MS = 2.0
#: The stages that every block of a sweep passes once; the stage "sum" is their sum.
STAGES = ("plan and key", "status, missing", "write", "status, stored", "read and sort")
FILE = Path(__file__).with_suffix(".csv")
LARGE = (
    ("--cases=1000000", "--per-block=80"),
    ("--cases=1000000", "--per-block=8"),
    ("--hub=10000",),
)


def measure(repeats: int = REPEATS, blocks: int = BLOCKS) -> list[dict[str, Any]]:
    """Measure milliseconds per block (medians); return one row per kind of block and stage.

    `ms_per_block` is by the clock. `cpu_ms` leaves out waiting for the disk and for other programs.
    """
    hub = get_study("hub")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        kinds = {
            "hub, 80 cases": (hub, compose([*STUDY, f"grid.replicates={blocks // 24 * 8}"])),
            "dummy, 80 cases": (BulkStudy(), bulk_config(place, 80 * blocks, 80)),
            "dummy, 8 cases": (BulkStudy(), bulk_config(place, 8 * blocks, 8)),
        }
        for number, (kind, (study, config)) in enumerate(kinds.items()):
            samples = [
                _stages(Run(place / f"{number}-{repeat}", config, study))
                for repeat in range(repeats)
            ]
            stages = {stage: median_time([one[stage] for one in samples]) for stage in samples[0]}
            terms = [stages[stage] for stage in STAGES]
            stages["sum"] = [sum(values) for values in zip(*terms, strict=True)]
            rows += [_row(kind, stage, *values) for stage, values in stages.items()]
        rows += _whole_sweep(place, repeats, blocks)
    return rows


def _stages(run: Run) -> dict[str, list[float]]:
    """Measure every stage of a run one by one: stage -> ms per block, by the clock and of CPU."""
    random = np.random.default_rng(0)
    run.store.cases.mkdir(parents=True)
    plan, planning = timed(lambda: make_plan(run.study, run.config))
    rows = [_rows(run, block, random) for block in plan.values()]
    versions = {"study": run.study.name, "schema_version": "1", "numerics_version": "1"}

    def status() -> list[str]:
        return [run.store.status(key) for key in plan]

    def write() -> None:
        for key, frame in zip(plan, rows, strict=True):
            run.store.write(key, encode(key, frame, versions))

    missing, before = timed(status)
    _, writing = timed(write)
    stored, after = timed(status)
    (rows_by_tuning, lacking), reading = timed(run.stored)
    _, aggregating = timed(lambda: run.make_results(rows_by_tuning))
    assert set(missing) == {"missing"}
    assert set(stored) == {"done"}
    assert not lacking
    seconds = (planning, before, writing, after, reading, aggregating)
    names = (*STAGES, "aggregate")
    return {
        name: [1e3 * value / len(plan) for value in pair]
        for name, pair in zip(names, seconds, strict=True)
    }


def _rows(run: Run, block: Any, random: np.random.Generator) -> Any:
    if run.study.name == "hub":
        return made_up_rows(block.content, random)
    return next(run.engine.run(run.config, [block]))[1]


def _whole_sweep(place: Path, repeats: int, blocks: int) -> list[dict[str, Any]]:
    """Measure whole sweeps of dummy blocks, with nothing stored and with everything stored."""
    first, again = [], []
    for repeat in range(repeats):
        config = bulk_config(place / f"whole-{repeat}", 80 * blocks, 80, workers=1)
        first.append(timed(lambda config=config: sweep(BulkStudy(), config))[1])
        again.append(timed(lambda config=config: sweep(BulkStudy(), config))[1])
    return [
        _row(
            "dummy, 80 cases",
            f"whole sweep, {what}",
            *(1e3 * value / blocks for value in median_time(pairs)),
        )
        for what, pairs in (("nothing stored", first), ("all stored", again))
    ]


def _row(block: str, stage: str, wall: float, cpu: float) -> dict[str, Any]:
    return {
        "block": block,
        "stage": stage,
        "ms_per_block": round(wall, 4),
        "cpu_ms": round(cpu, 4),
    }


def large() -> list[dict[str, Any]]:
    """Measure seconds per stage and peak memory of large plans, once each, in their own process."""
    rows = []
    for arguments in LARGE:
        done = subprocess.run(
            [sys.executable, "-m", "benchmarks.scale", *arguments],
            capture_output=True,
            text=True,
            check=True,
            cwd=ROOT,
        )
        rows.append(json.loads(done.stdout.splitlines()[-1]))
    return rows


def write_csv(rows: list[dict[str, Any]]) -> None:
    """Write the rows as bookkeeping.csv beside this file."""
    write_table(FILE.parent, FILE.stem, pd.DataFrame(rows))


def block_table(rows: list[dict[str, Any]]) -> str:
    lines = ["| block | stage | ms | of them CPU |", "|---|---|---|---|"]
    for row in rows:
        figures = f"{row['ms_per_block']:.2f} | {row['cpu_ms']:.2f}"
        lines.append(f"| {row['block']} | {row['stage']} | {figures} |")
    return "\n".join(lines) + "\n"


def plan_table(plans: list[dict[str, Any]]) -> str:
    lines = ["| cases | blocks | seconds | peak, MB |", "|---|---|---|---|"]
    for plan in plans:
        stages = ", ".join(f"{name} {value:.1f}" for name, value in plan["seconds"].items())
        lines.append(f"| {plan['cases']} | {plan['blocks']} | {stages} | {plan['peak_MB']} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Measure, print, and write the tables; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="also whole large plans")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/scaling.md")
    options = parser.parse_args()
    rows = measure()
    print(f"{'block':<16} {'stage':<30} {'ms':>8} {'cpu ms':>8}")
    for row in rows:
        over = "  over the goal" if row["stage"] == "sum" and row["ms_per_block"] > GOAL_MS else ""
        figures = f"{row['ms_per_block']:8.3f} {row['cpu_ms']:8.3f}"
        print(f"{row['block']:<16} {row['stage']:<30} {figures}{over}")
    write_csv(rows)
    plans = large() if options.large else []
    for plan in plans:
        print(json.dumps(plan))
    if options.write:
        put("bookkeeping", block_table(rows))
    if options.write and plans:
        put("large", plan_table(plans))
    return 0


if __name__ == "__main__":
    sys.exit(main())
