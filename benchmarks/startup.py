"""Measure how long a user waits before anything is computed; each command is a new process."""

from __future__ import annotations

import json
import subprocess
import sys
from statistics import median
from typing import Any

from benchmarks import ROOT
from benchmarks.timing import REPEATS, seconds

BARE = ("-c", "pass")
#: The commands: what is run, the goal in s, and the arguments to Python.
COMMANDS = (
    ("`import owtsweep` (the interpreter's own start taken off)", 0.1, ("-c", "import owtsweep")),
    ("`python -m owtsweep --help`", 0.3, ("-m", "owtsweep", "--help")),
    ("sweep of a 2-cell study without figures, warm cache", 4.0, ("-m", "benchmarks.two_cells")),
)


def measure(repeats: int = REPEATS) -> list[dict[str, Any]]:
    """Measure the median wall time (s) of each command's process; return one row per command.

    Each row also has the goal in s (None for the interpreter alone) and a note.
    """
    bare = _run(BARE, repeats)
    rows: list[dict[str, Any]] = [
        {"what": "the interpreter alone", "seconds": bare, "goal": None, "note": ""}
    ]
    for what, goal, arguments in COMMANDS:
        taken = _run(arguments, repeats)
        note = ""
        if what.startswith("sweep"):
            stages = [json.loads(_output((*arguments, "again"))) for _ in range(repeats)]
            cpu, again = (median(stage[key] for stage in stages) for key in ("cpu", "again"))
            note = (
                f"a second one in the same process takes {again:.2f} s: the rest, once per "
                "process, is importing libraries, loading kernels and making the schemes' gains "
                f"({cpu:.2f} core-seconds in all)"
            )
        least = taken - bare if what.startswith("`import") else taken
        rows.append({"what": what, "seconds": least, "goal": goal, "note": note})
    return rows


def _run(arguments: tuple[str, ...], repeats: int) -> float:
    return seconds(lambda: _output(arguments), repeats=repeats)


def _output(arguments: tuple[str, ...]) -> str:
    command = [sys.executable, *arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT).stdout


if __name__ == "__main__":
    for row in measure():
        print(row)
