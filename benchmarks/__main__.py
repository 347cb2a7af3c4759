"""Measure everything side by side and write the report.

    python -m benchmarks                   all: some 16 minutes on two quiet cores
    python -m benchmarks --quick           the same at smaller sizes: 2-3 minutes
    python -m benchmarks --only kernels study
    python -m benchmarks --again           the report from the numbers of the last run
    python -m benchmarks --large           then also plans of millions of cases, for docs/scaling.md

A full run writes report.md, its pictures and measured.json beside this file, and the tables of
docs/scaling.md; all others write to results/bench.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from benchmarks import bookkeeping, put, report, scaling
from benchmarks.environment import busy, describe
from benchmarks.parts import PARTS, measure_part

HERE = Path(__file__).resolve().parent
ELSEWHERE = HERE.parent / "results" / "bench"


def measure(names: list[str], quick: bool) -> dict[str, Any]:
    """Measure some parts; return their numbers by part, and what the report says of the machine."""
    results: dict[str, Any] = {"quick": quick, "machine": describe(), "busy_before": busy()}
    spent, failed = {}, {}
    for name in names:
        print(f"{name} ...", end=" ", flush=True)
        began = time.perf_counter()
        try:
            results[name] = measure_part(name, "quick" if quick else "full")
        except Exception as error:  # minutes of other parts must not be lost with this one
            failed[name] = f"{type(error).__name__}: {error}"
            print(failed[name], file=sys.stderr)
        spent[name] = time.perf_counter() - began
        print(f"{spent[name]:.0f} s", flush=True)
    return {**results, "busy_after": busy(), "spent": spent, "failed": failed}


def refresh_scaling(rows: list[dict[str, Any]], *, large: bool) -> None:
    """Replace the tables of docs/scaling.md; `rows` are the results of `bookkeeping.measure`."""
    bookkeeping.write_csv(rows)
    put("bookkeeping", bookkeeping.block_table(rows))
    print("docs/scaling.md ...", flush=True)
    put("growth", scaling.tables())
    if large:
        put("large", bookkeeping.plan_table(bookkeeping.large()))


def main() -> int:
    """Measure, write the report, and print its path; return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", nargs="+", choices=[*PARTS], metavar="PART")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--large", action="store_true")
    options = parser.parse_args()
    full = not (options.quick or options.only)
    folder = HERE if full else ELSEWHERE
    folder.mkdir(parents=True, exist_ok=True)
    numbers = folder / "measured.json"
    if options.again:
        results = json.loads(numbers.read_text(encoding="utf-8"))
    else:
        results = measure(options.only or [*PARTS], options.quick)
        numbers.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(report.write(results, folder))
    if full and not options.again and "bookkeeping" in results:
        refresh_scaling(results["bookkeeping"], large=options.large)
    return 1 if results["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
