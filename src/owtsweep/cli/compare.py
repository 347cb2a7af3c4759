"""`compare`: how results differ between the runs of a multirun, or between given runs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.cli.program import DONE

if TYPE_CHECKING:
    import pandas as pd


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write the comparison and print a short form of it."""
    from owtsweep.api import load
    from owtsweep.sweep.compare import compare

    compared = compare(options.runs, load)
    if sys.stdout.isatty():
        from rich.console import Console

        Console().print(_make_table(compared.overview))
    else:
        print(compared.overview.to_string(index=False))
    for note in compared.notes:
        print(f"note: {note}", file=sys.stderr)
    files = len(compared.findings.tables) + len(compared.findings.figures) + 1
    print(f"{files} files: {compared.folder / 'comparison.md'}")
    return DONE


def _make_table(overview: pd.DataFrame) -> object:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE, header_style="")
    for column in overview.columns:
        table.add_column(column, justify="right", overflow="fold")
    for row in overview.itertuples(index=False):
        table.add_row(*row)
    return table
