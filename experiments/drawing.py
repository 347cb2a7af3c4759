"""Draw a figure from a run whose folder is the script's argument."""

import sys

import owtsweep
from owtsweep.sweep.runs import Run


def open_run() -> Run:
    """Return the run that the first argument names, or the default study, run first if needed."""
    return owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()


def draw_figure(name: str) -> None:
    """Draw a figure of the run into its folder figures/, and print the files."""
    for file in open_run().draw(name):
        print(file)
