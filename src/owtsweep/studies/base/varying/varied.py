"""Writes the errors over the values of a key as table and figure, and tells them on a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.figures.drawings import save_figure
from owtsweep.io.tables import write_table
from owtsweep.io.terminal import start_table
from owtsweep.results.conditions import show_value
from owtsweep.studies.base.varying.errors import Errors
from owtsweep.studies.base.varying.sentences import answer_each

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table


@dataclass(frozen=True)
class VariedErrors:
    """The errors over the values of a key, an `owtsweep.sweep.study.Varied`."""

    errors: Errors

    def write(self, folder: Path, metadata: Mapping[str, str]) -> list[Path]:
        """Write vary.csv, vary.png and vary.svg into `folder`; return their paths."""
        from owtsweep.studies.base.varying import drawing

        files = save_figure(partial(drawing.draw, self.errors), metadata)(folder, "vary")
        return [*files, write_table(folder, "vary", self.errors.table)]

    def answer(self) -> RenderableType:
        from rich.console import Group
        from rich.text import Text

        make = _list_all if self.errors.interval is None else _list_first
        tables = [make(self.errors, number) for number in range(len(self.errors.cells))]
        facts = f"At all values: {'; '.join(self.errors.facts)}"
        notes = [" ".join(self.errors.notes)] if self.errors.notes else []
        sentences = [*answer_each(self.errors), *notes]
        return Group(Text(facts), *tables, *(Text(sentence) for sentence in sentences))


def _list_all(errors: Errors, cell: int) -> Table:
    """Make a table of all errors: a row per value, a column per scheme."""
    from rich.text import Text

    bound = () if errors.bound is None else ("bound",)
    table = _start_table(errors, cell)
    for column in (*errors.names, *bound):
        table.add_column(Text(column), justify="right", no_wrap=True)
    table.add_column("best")
    for n, value in enumerate(errors.values):
        cells = [f"{error:.3g}" for error in errors.error[:, n, cell]]
        cells += [] if errors.bound is None else [f"{errors.bound[n]:.3g}"]
        table.add_row(Text(show_value(value)), *cells, Text(errors.name_best(n, cell)))
    return table


def _list_first(errors: Errors, cell: int) -> Table:
    """Make a table of the two least errors at each value, with intervals."""
    from rich.text import Text

    table = _start_table(errors, cell)
    for column in ("best", "error", "95 % interval", "next", "error"):
        table.add_column(column, justify="left" if column in ("best", "next") else "right")
    of_schemes = errors.error[: len(errors.schemes), :, cell]
    assert errors.interval is not None
    low, high = (end[:, :, cell] for end in errors.interval)
    for n, value in enumerate(errors.values):
        order = [int(s) for s in np.argsort(of_schemes[:, n]) if np.isfinite(of_schemes[s, n])]
        cells = [errors.name_best_scheme(n, cell)]
        for s in order[:1]:
            known = np.isfinite(high[s, n])
            ends = f"{low[s, n]:.3g} to {high[s, n]:.3g}" if known else "-"
            cells += [f"{of_schemes[s, n]:.3g}", ends]
        for s in order[1:2]:
            cells += [errors.schemes[s], f"{of_schemes[s, n]:.3g}"]
        table.add_row(Text(show_value(value)), *map(Text, cells))
    return table


def _start_table(errors: Errors, cell: int) -> Table:
    from rich.text import Text

    title = f"Settled {errors.title} over {errors.along.title}; {errors.cells[cell]}"
    table = start_table(title, padding=(0, 1, 0, 0))
    # Numbers are never cut: ten columns of them fit into 80 characters.
    table.add_column(Text(errors.along.unit or "value"), justify="right", overflow="fold")
    return table
