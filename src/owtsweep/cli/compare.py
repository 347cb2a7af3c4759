"""The command `compare`: show how the results of several runs of one study differ."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from owtsweep.cli.program import DONE
from owtsweep.errors import printable
from owtsweep.io.files import refuse_in_one_line


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Compare the runs named in `options.runs`: write files, print an overview, and return 0.

    `options` are the parsed arguments of the command; `argv` is not used.

    Raises InputError if a run cannot be read, the runs cannot be compared, or a file cannot be
        written.
    """
    from owtsweep.api import load
    from owtsweep.sweep.compare import compare

    with refuse_in_one_line(Path(options.runs[0])):
        compared = compare(options.runs, load)
    if compared.findings.origin:
        print(printable(compared.findings.origin))
    if sys.stdout.isatty():
        from rich.console import Console

        from owtsweep.io.terminal import PartedTable

        overview = compared.overview
        swept = len(overview.columns) - len(compared.findings.overview.columns)
        rows = list(overview.itertuples(index=False, name=None))
        table = PartedTable(list(overview.columns), rows, repeated=swept)
        Console(markup=False, emoji=False).print(table)  # names are shown as typed
    else:
        print(compared.overview.to_string(index=False))
    for note in compared.notes:
        print(f"note: {note}", file=sys.stderr)
    files = len(compared.findings.tables) + len(compared.findings.figures) + 1
    print(f"{files} files: {printable(str(compared.folder / 'comparison.md'))}")
    return DONE
