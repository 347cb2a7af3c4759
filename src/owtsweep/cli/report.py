"""The command `report`: write the page of a run, one HTML file to send."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from owtsweep.cli.program import DONE
from owtsweep.errors import InputError, printable
from owtsweep.io.files import check_writable, refuse_in_one_line


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write the page of the run `options.run`, and return 0.

    It is report.html in the run's folder, or the file `options.output`. `argv` is not used.

    Raises InputError if the folder holds no run or no succeeded case, or the page cannot be
        written.
    """
    from owtsweep.api import load
    from owtsweep.io.terminal import show_steps

    opened = load(options.run)
    output = None if options.output is None else Path(options.output).expanduser()
    if output is not None and output.is_dir():
        raise InputError(f"--output: {output} is a folder; name a file, e.g. {output}/report.html")
    place = opened.place if output is None else output.parent
    argument = "RUN" if output is None else "--output"
    check_writable(place, argument, "give --output a file in a folder where you may write")
    with refuse_in_one_line(place), show_steps():
        path = opened.write_report(output, details=options.details)
    print(printable(str(path)))
    return DONE
