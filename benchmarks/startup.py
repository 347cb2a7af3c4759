"""How long a user waits before anything is computed; every line is a process of its own."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.timing import seconds

#: What is run, its goal (s), and the arguments to Python; {results} is an empty folder.
COMMANDS = (
    ("import owtsweep", 0.1, ("-c", "import owtsweep")),
    ("--help", 0.3, ("-m", "owtsweep", "--help")),
    (
        "sweep of 2 cells, no figures",
        4.0,
        ("-c", "from benchmarks.startup import two_cells; two_cells()"),
    ),
)
BARE = ("-c", "pass")


def two_cells() -> None:
    """A study of two cells in an empty folder, without figures."""
    import owtsweep

    with tempfile.TemporaryDirectory() as results:
        owtsweep.run(
            [
                f"results={results}",
                "grid.natural_period=[4.0]",
                "grid.amplitude=[0.1,1.0]",
                "grid.replicates=1",
            ]
        )


def measure(repeats: int = 5) -> list[dict[str, object]]:
    """One row per command: median wall time (s), its goal, and whether it was met."""
    bare = _run(BARE, repeats)
    rows: list[dict[str, object]] = []
    for name, goal, arguments in COMMANDS:
        taken = _run(arguments, repeats)
        # The goal of the import is the import's own time, not the interpreter's start.
        own = taken - bare if name.startswith("import") else taken
        rows.append({"what": name, "seconds": own, "goal": goal, "met": own <= goal})
    return rows


def _run(arguments: tuple[str, ...], repeats: int) -> float:
    root = Path(__file__).resolve().parents[1]
    command = [sys.executable, *arguments]
    return seconds(
        lambda: subprocess.run(command, check=True, capture_output=True, cwd=root), repeats=repeats
    )


if __name__ == "__main__":
    for row in measure():
        print(row)
