"""The best-scheme map in the terminal, shown at the end of `sweep`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.figures.palette import style_of
from owtsweep.figures.plane import Plane
from owtsweep.results.conditions import Condition

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType
    from rich.table import Table
    from rich.text import Text

    #: Column and line number -> best scheme, and whether it is distinguishable.
    Winners = dict[tuple[int, int], tuple[str, bool]]

#: Mark after a name where the data do not distinguish the best scheme from the next.
MARK = "~"
NO_RESULT = "-"
#: Width of one table in characters; a wider grid continues below.
WIDTH = 64


def grid(
    best: pd.DataFrame,
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    criterion: str,
    window: str,
) -> RenderableType:
    """The map as a coloured grid: the first condition across, the second upwards.

    Parameters
    ----------
    best
        Columns of best_scheme.csv.
    schemes
        All schemes compared.
    conditions
        The study's conditions. With more than two, there is one grid for each combination of the
        values of the others.
    criterion, window
        The rows to show.
    """
    from rich.console import Group
    from rich.text import Text

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
    return Group(*parts)


def _make_tables(best: pd.DataFrame, schemes: Sequence[str], plane: Plane) -> list[Table]:
    winners: Winners = {
        plane.place(row): (row["best"], bool(row["distinguishable"]))
        for row in best.to_dict("records")
    }
    cell_width = max(len(name) for name in schemes) + len(MARK) + 3
    step = max(1, WIDTH // (cell_width + 2))
    columns = range(len(plane.columns))
    return [
        _make_table(winners, schemes, plane, columns[start : start + step])
        for start in columns[::step]
    ]


def _make_table(
    winners: Winners, schemes: Sequence[str], plane: Plane, columns: Sequence[int]
) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE, padding=(0, 1), header_style="")
    upwards = plane.upwards
    table.add_column(upwards.word if upwards else "", justify="right", no_wrap=True)
    for column in columns:
        shown = plane.across.show(plane.columns[column])
        table.add_column(shown, justify="center", no_wrap=True)
    for line in reversed(range(len(plane.lines))):
        cells = [_make_cell(winners.get((column, line)), schemes) for column in columns]
        table.add_row(upwards.show(plane.lines[line]) if upwards else "", *cells)
    return table


def _make_cell(winner: tuple[str, bool] | None, schemes: Sequence[str]) -> Text:
    from rich.style import Style
    from rich.text import Text

    if winner is None:
        return Text(NO_RESULT)
    name, distinguishable = winner
    look = style_of(name, schemes)
    width = max(len(scheme) for scheme in schemes)
    mark = " " if distinguishable else MARK
    return Text(f" {name:^{width}} {mark}", style=Style(color=look.text_color, bgcolor=look.color))


def _make_legend(best: pd.DataFrame, schemes: Sequence[str]) -> Text:
    from rich.text import Text

    names = best["best"].to_list()
    counts = ", ".join(f"{name} {names.count(name)}" for name in schemes if name in names)
    legend = f"cells won: {counts}"
    if not best["distinguishable"].all():
        legend += f"; {MARK} not distinguishable from the runner-up"
    return Text(legend)
