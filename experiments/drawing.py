"""Draw a figure from a run, or into a folder, that the script's argument names."""

import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import owtsweep
from owtsweep.sweep.runs import Run


def open_run() -> Run:
    """Return the run that the first argument names, or the default study, run first if needed."""
    return owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()


def draw_figure(name: str) -> None:
    """Draw a figure of the run into its folder figures/, and print the files."""
    for file in open_run().draw(name):
        print(file)


def draw_into(default: str, draw: Callable[[Path], Iterable[Path]]) -> None:
    """Draw into the folder that the first argument names, or a default one; print the files."""
    for file in draw(Path(sys.argv[1] if len(sys.argv) > 1 else default)):
        print(file)
