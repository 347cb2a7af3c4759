"""One large sweep of dummy blocks in one process: stopped half way, resumed, aggregated, checked.

    python -m benchmarks.scale [--cases 1000000] [--per-block 80]
    python -m benchmarks.scale --hub 10000

The second lays out the default hub study with so many replicates on made-up shards, and aggregates
them and draws the map. Each prints one line of JSON with seconds per stage and the peak memory of
the process. A process of its own for each: a peak never goes down.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import STUDY
from owtsweep.studies import compose, get_study
from owtsweep.sweep.plan import count_cases, make_plan
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.store import encode


class Clock:
    """A clock that measures the seconds of named stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.seconds[name] = round(time.perf_counter() - began, 3)


class StopAfter(Progress):
    """A progress display that interrupts the sweep after `cases` cases, as Ctrl-C does."""

    def __init__(self, cases: int) -> None:
        self.left = cases

    def advance(self, cases: int) -> None:
        self.left -= cases
        if self.left <= 0:
            raise KeyboardInterrupt


def bulk(cases: int, per_block: int) -> dict[str, Any]:
    """Run a study of dummy blocks: stop it half way, resume, run it again, and check the sums.

    Returns the numbers of blocks and cases, whether the sums are correct, and seconds per stage.
    """
    from benchmarks.bulk_study import SCHEMES, BulkStudy, bulk_config, value

    clock = Clock()
    study = BulkStudy()
    with tempfile.TemporaryDirectory() as folder:
        config = bulk_config(Path(folder), cases, per_block)
        with clock.stage("plan"):
            plan = make_plan(study, config)
        blocks, total = len(plan), count_cases(plan)
        del plan
        with clock.stage("first half"), suppress(KeyboardInterrupt):
            sweep(study, config, progress=StopAfter(total // 2))
        with clock.stage("second half and aggregate"):
            resumed = sweep(study, config)
        with clock.stage("nothing left, aggregate"):
            again = sweep(study, config)
        each = np.arange(total // len(SCHEMES))
        expected = [[scheme, value(scheme, each).sum(), len(each)] for scheme in SCHEMES]
        correct = again.run.summary().to_numpy().tolist() == expected
        correct &= resumed.computed + resumed.reused == again.reused == total
        correct &= resumed.reused >= total // 2 > 0 and again.computed == 0
    return {"blocks": blocks, "cases": total, "correct": correct, "seconds": clock.seconds}


def hub(replicates: int) -> dict[str, Any]:
    """Make up the shards of the default hub study, then read and aggregate them and draw the map.

    Returns the numbers of blocks, cases and rows, whether all is complete, and seconds per stage.
    """
    clock = Clock()
    study = get_study("hub")
    with tempfile.TemporaryDirectory() as folder:
        config = compose([*STUDY, f"grid.replicates={replicates}", f"results={folder}"])
        with clock.stage("plan"):
            plan = make_plan(study, config)
        run = Run(Path(folder) / "run", config, study)
        run.store.cases.mkdir(parents=True)
        with clock.stage("make up shards"):
            _make_up(run, plan)
        with clock.stage("status"):
            done = sum(run.store.status(key) == "done" for key in plan)
        with clock.stage("read"):
            stored, missing = run.stored()
        with clock.stage("aggregate"):
            results = run.make_results(stored)
        with clock.stage("map"):
            files = run.draw(results=results, overview=True)
        correct = done == len(plan) and not missing and len(files) > 0
        correct &= set(results[""].tables["summary"]["n"]) == {replicates}
    return {
        "blocks": len(plan),
        "cases": count_cases(plan),
        "rows": len(stored[""]),
        "correct": bool(correct),
        "seconds": clock.seconds,
    }


def _make_up(run: Run, plan: Any) -> None:
    """Write shards like those of a sweep, but with random numbers and without disk flushes."""
    random = np.random.default_rng(0)
    for key, block in plan.items():
        frame = made_up_rows(block.content, random)
        run.store.path(key).write_bytes(encode(key, frame, {"schema_version": "1"}))


def made_up_rows(content: Any, random: np.random.Generator) -> Any:
    """Make the rows of a superposed block of the hub study, with random products."""
    import pandas as pd

    from owtsweep.studies.hub.measures import MEASURES, WINDOWS

    replicates = range(*content["replicates"])
    each = len(MEASURES) * len(WINDOWS)
    size = each * len(replicates)
    table = {
        "natural_period": content["natural_period"],
        "replicate": np.repeat(replicates, each),
        "scheme": content["scheme"],
        "measure": list(MEASURES) * (size // len(MEASURES)),
        "window": np.repeat([*WINDOWS] * len(replicates), len(MEASURES)),
        "amplitude": np.nan,
        "motion": random.random(size),
        "cross": random.random(size),
        "noise": random.random(size),
        "value": np.nan,
        "n_samples": 200_000,
        "status": "ok",
        "reason": "",
    }
    return pd.DataFrame(table, index=range(size))


def peak_megabytes() -> float:
    """Return the largest resident size of this process so far, in 10^6 bytes."""
    status = Path("/proc/self/status")
    if status.is_file():
        # Not getrusage: its peak counts the parent too, whose memory a fork shares until it execs.
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return int(lines["VmHWM"].split()[0]) * 1024 / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


def main() -> int:
    """Run what the command line asks for, and print time and memory; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1_000_000)
    parser.add_argument("--per-block", type=int, default=80)
    parser.add_argument("--hub", type=int, metavar="REPLICATES")
    options = parser.parse_args()
    outcome = hub(options.hub) if options.hub else bulk(options.cases, options.per_block)
    print(json.dumps({**outcome, "peak_MB": round(peak_megabytes())}))
    return 0 if outcome["correct"] else 1


if __name__ == "__main__":
    sys.exit(main())
