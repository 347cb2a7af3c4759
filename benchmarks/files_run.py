"""Count the files of the package whose functions run in one case of the hub study, and list them.

    python -m benchmarks.files_run [OVERRIDE...]
    python -m benchmarks.files_run --page         also write them into docs/files_of_a_case.md

The case is one scheme in one record under one condition (`CASE`); overrides come after it. The
command `sweep` runs it in this process and in one thread, without a bar and without figures; the
kernels were compiled before, by another process. A file counts if Python code of one of its
functions ran, at its import or later; what numba has compiled leaves no trace. The last line counts
the files of a second case in this process, when all is imported and what is kept in memory serves.

The files are listed in the order in which their functions are first called. On the way from
configuration to score are those of `ROOMS` that come before `AFTER`.
"""

from __future__ import annotations

import ast
import inspect
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from itertools import takewhile
from pathlib import Path
from types import CodeType, FrameType

import owtsweep
from benchmarks import put

PACKAGE = Path(owtsweep.__file__).resolve().parent
OURS = f"{PACKAGE}{os.sep}"
#: Rooms from configuration to score.
ROOMS = ("studies", "estimation", "motion", "sensing")
#: The first file that takes scores: what is first called after it is not on the way.
AFTER = "sweep/gather.py"
CASE = (
    "schemes=[HME1]", "baselines=[]", "tuning=paper", "grid.natural_period=[4.0]",
    "grid.amplitude=[1.0]", "grid.replicates=1", "record.duration=60", "compute=single",
    "compute.backend=threading",
)  # fmt: skip


def trace(function: Callable[[], object]) -> list[str]:
    """Return the package's files whose functions run while `function` runs, in any thread.

    Names are relative to the package, e.g. "studies/hub/batch.py". They are in the order in which
    functions of the files are first called; those that only an import calls come last. Bodies of
    modules and classes are no functions.
    """
    called: dict[CodeType, None] = {}
    at_import: dict[CodeType, None] = {}

    def note(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        is_function = event == "call" and bool(code.co_flags & inspect.CO_OPTIMIZED)
        if is_function and code.co_filename.startswith(OURS) and code not in called:
            (at_import if is_importing(frame) else called)[code] = None

    threading.setprofile(note)
    sys.setprofile(note)
    try:
        function()
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]  # None takes the function away
    paths = dict.fromkeys(Path(code.co_filename) for code in [*called, *at_import])
    return [path.relative_to(PACKAGE).as_posix() for path in paths]


def is_importing(frame: FrameType | None) -> bool:
    """Return whether a frame is called, directly or not, by the body of a module of the package."""
    while frame is not None:
        code = frame.f_code
        if code.co_name == "<module>" and code.co_filename.startswith(OURS):
            return True
        frame = frame.f_back
    return False


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


def count(files: Sequence[str]) -> str:
    """Say how many files are on the way from configuration to score, and how many in all."""
    on_the_way = sum(file.split("/")[0] in ROOMS for file in takewhile(AFTER.__ne__, files))
    return f"from configuration to score {on_the_way}, in all {len(files)}"


def make_table(files: Sequence[str]) -> str:
    """Return the files in order, each with the first line of its docstring, as Markdown."""
    from owtsweep.io.markdown import table

    rows = [[f"`{file}`", read_docstring(PACKAGE / file)] for file in files]
    listed = table(["file", "what it says of itself"], rows)
    return f"Files of one case: {count(files)}.\n\n{listed}\n"


def read_docstring(path: Path) -> str:
    """Return the first line of a module's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text("utf-8"))) or "").partition("\n")[0]


def main() -> None:
    """Compile, run the case twice, and print the files or write the page."""
    words = [word for word in sys.argv[1:] if word != "--page"]
    compiling = f"from benchmarks.files_run import run_case; run_case({words})"
    subprocess.run([sys.executable, "-c", compiling], check=True)
    first = trace(lambda: run_case(words))
    if "--page" in sys.argv:
        put("files of one case", make_table(first), "files_of_a_case.md")
    print(*first, sep="\n")
    print(f"files of one case: {count(first)}")
    again = trace(lambda: run_case(words))
    print(f"files of a second case in this process: {count(again)}")


if __name__ == "__main__":
    main()
