"""Count the files of the package whose functions run in one case of the hub study, and list them.

    python -m benchmarks.files_run [OVERRIDE...]

The case is one scheme in one record under one condition (`CASE`); overrides come after it. The
command `sweep` runs it in this process and in one thread, without a bar and without figures; the
kernels were compiled before, by another process. A file counts if Python code of one of its
functions ran, at its import or later; what numba has compiled leaves no trace. The last line counts
the files of a second case in this process, when all is imported and what is kept in memory serves.

First come the files from configuration to score: those of `ROOMS`. Then come the others.
"""

from __future__ import annotations

import inspect
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from types import FrameType
from typing import Any

import owtsweep

PACKAGE = Path(owtsweep.__file__).resolve().parent
#: Rooms from configuration to score.
ROOMS = ("studies", "estimation", "motion", "sensing", "vectors")
CASE = (
    "schemes=[HME1]", "baselines=[]", "tuning=paper", "grid.natural_period=[4.0]",
    "grid.amplitude=[1.0]", "grid.replicates=1", "record.duration=60", "compute=single",
    "compute.backend=threading",
)  # fmt: skip


def trace(function: Callable[[], object]) -> set[str]:
    """Return the package's files whose functions run while `function` runs, in any thread.

    Names are relative to the package, e.g. "studies/hub/batch.py". Bodies of modules and classes
    are no functions.
    """
    seen: set[Any] = set()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            seen.add(frame.f_code)

    threading.setprofile(note)
    sys.setprofile(note)
    try:
        function()
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]  # None takes the function away
    functions = (code for code in seen if code.co_flags & inspect.CO_OPTIMIZED)
    paths = {Path(code.co_filename) for code in functions}
    return {path.relative_to(PACKAGE).as_posix() for path in paths if path.is_relative_to(PACKAGE)}


def run_case(overrides: Sequence[str] = ()) -> None:
    """Run the case by the command `sweep`; raise RuntimeError with what it said if it fails."""
    from owtsweep.cli import main

    said = StringIO()
    with tempfile.TemporaryDirectory() as results:
        words = ["sweep", *CASE, *overrides, f"results={results}"]
        with redirect_stdout(said), redirect_stderr(said):
            code = main(words)
    if code:
        raise RuntimeError(said.getvalue())


def is_on_the_way(file: str) -> bool:
    """Return whether a file is in one of the rooms from configuration to score."""
    return file.split("/")[0] in ROOMS


def count(files: Iterable[str]) -> str:
    """Say how many files are on the way from configuration to score, and how many in all."""
    files = list(files)
    return f"from configuration to score {sum(map(is_on_the_way, files))}, in all {len(files)}"


if __name__ == "__main__":
    if sys.argv[1:2] == ["--compile"]:
        run_case(sys.argv[2:])
        sys.exit()
    compiling = [sys.executable, "-m", "benchmarks.files_run", "--compile", *sys.argv[1:]]
    subprocess.run(compiling, check=True)
    first, again = (trace(lambda: run_case(sys.argv[1:])) for _ in range(2))
    way = sorted(filter(is_on_the_way, first))
    print(f"from configuration to score ({', '.join(ROOMS)}): {len(way)} files", *way, sep="\n  ")
    others = sorted(first.difference(way))
    print(f"others: {len(others)} files", *others, sep="\n  ")
    print(f"files of one case: {count(first)}")
    print(f"files of a second case in this process: {count(again)}")
