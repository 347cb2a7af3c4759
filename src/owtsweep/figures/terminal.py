"""Show the best-scheme map in the terminal, at the end of the command `sweep`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from rich import box
from rich.console import Group, RenderableType
from rich.style import Style
from rich.table import Table
from rich.text import Text

from owtsweep.figures.palette import style_of
from owtsweep.figures.plane import Plane
from owtsweep.results.conditions import Condition

#: Mark after a scheme's name in cells where the data do not distinguish it from the next best.
MARK = "~"
NO_RESULT = "-"
#: Width of one table in characters; the columns of a wider map continue in a table below.
WIDTH = 64


def grid(
    best: pd.DataFrame,
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    criterion: str,
    window: str,
    *,
    notes: Sequence[str] = (),
) -> RenderableType:
    """Make the map as a coloured grid: first condition horizontal, second vertical.

    Parameters
    ----------
    best
        The table best_scheme.csv of a run.
    schemes
        All schemes that are named in the table.
    conditions
        The study's conditions. There is one grid for each combination of values of the third and
        any further condition.
    criterion, window
        Measure and window of the rows to show. If there are no such rows, a sentence that says so
        is returned.
    notes
        Sentences below the map.
    """
    shown = best[(best["criterion"] == criterion) & (best["window"] == window)]
    if shown.empty:
        return Text(f"No cell to compare by {criterion} MSE ({window} record).")
    parts: list[RenderableType] = [
        Text(f"Best scheme by {criterion} MSE, {window} record", style="bold")
    ]
    further = conditions[2:]
    names = [condition.name for condition in further]
    groups: Any = shown.groupby(names, sort=False) if names else [((), shown)]
    for values, cells in groups:
        if names:
            told = zip(further, values, strict=True)
            parts.append(Text(", ".join(f"{c.word} {c.show(value)}" for c, value in told)))
        parts += _make_tables(cells, schemes, Plane.of(cells, conditions[:2]))
    parts.append(_make_legend(shown, schemes))
    parts += [Text(note) for note in notes]
    return Group(*parts)


def _make_tables(best: pd.DataFrame, schemes: Sequence[str], plane: Plane) -> list[Table]:
    width = max(len(name) for name in schemes)
    cells = {plane.place(row): _make_cell(row, schemes, width) for row in best.to_dict("records")}
    step = max(1, WIDTH // (width + len(MARK) + 5))
    columns = range(len(plane.columns))
    return [_make_table(cells, plane, columns[start : start + step]) for start in columns[::step]]


def _make_table(
    cells: Mapping[tuple[int, int], Text], plane: Plane, columns: Sequence[int]
) -> Table:
    """Make the table of some columns of the map.

    Parameters
    ----------
    cells
        (column, line) of a cell -> its text.
    columns
        The columns to show.
    """
    table = Table(box=box.SIMPLE, padding=(0, 1), header_style="")
    upwards = plane.upwards
    table.add_column(upwards.word if upwards else "", justify="right", no_wrap=True)
    for column in columns:
        shown = plane.across.show(plane.columns[column])
        table.add_column(shown, justify="center", no_wrap=True)
    for line in reversed(range(len(plane.lines))):
        value = upwards.show(plane.lines[line]) if upwards else ""
        table.add_row(value, *(cells.get((column, line), NO_RESULT) for column in columns))
    return table


def _make_cell(row: Mapping[Any, Any], schemes: Sequence[str], width: int) -> Text:
    look = style_of(row["best"], schemes)
    mark = " " if row["distinguishable"] else MARK
    text = f" {row['best']:^{width}} {mark}"
    return Text(text, style=Style(color=look.text_color, bgcolor=look.color))


def _make_legend(best: pd.DataFrame, schemes: Sequence[str]) -> Text:
    names = best["best"].to_list()
    counts = ", ".join(f"{name} {names.count(name)}" for name in schemes if name in names)
    legend = f"cells won: {counts}"
    if not best["distinguishable"].all():
        legend += f"; {MARK} not distinguishable from the runner-up"
    return Text(legend)
