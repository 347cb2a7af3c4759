"""The best-scheme map in the terminal: what `sweep` shows at its end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.figures.palette import style_of

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType
    from rich.table import Table
    from rich.text import Text

    #: Best scheme and whether it is distinguishable, by (natural period, amplitude).
    Winners = dict[tuple[float, float], tuple[str, bool]]

#: Stands behind a name where the data do not tell the best scheme from the next.
MARK = "~"
NO_RESULT = "-"
#: Characters for the columns of one table; wider grids go on below.
WIDTH = 64


def grid(best: pd.DataFrame, schemes: Sequence[str], criterion: str, window: str) -> RenderableType:
    """The map as a coloured grid: amplitudes downwards from the largest, natural periods across.

    Parameters
    ----------
    best
        Columns of best_scheme.csv.
    schemes
        All schemes compared.
    criterion, window
        The rows to show.
    """
    from rich.console import Group
    from rich.text import Text

    shown = best[(best["criterion"] == criterion) & (best["window"] == window)]
    if shown.empty:
        return Text(f"No cell to compare by {criterion} MSE ({window} record).")
    winners: Winners = {
        (row["natural_period"], row["amplitude"]): (row["best"], bool(row["distinguishable"]))
        for row in shown.to_dict("records")
    }
    periods = sorted({period for period, _ in winners})
    amplitudes = sorted({amplitude for _, amplitude in winners}, reverse=True)
    cell_width = max(len(name) for name in schemes) + len(MARK) + 3
    columns = max(1, WIDTH // (cell_width + 2))
    tables = [
        _table(winners, schemes, periods[start : start + columns], amplitudes)
        for start in range(0, len(periods), columns)
    ]
    title = Text(f"Best scheme by {criterion} MSE, {window} record", style="bold")
    return Group(title, *tables, _legend(winners, schemes))


def _table(
    winners: Winners,
    schemes: Sequence[str],
    periods: Sequence[float],
    amplitudes: Sequence[float],
) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE, padding=(0, 1), header_style="")
    table.add_column("amplitude", justify="right", no_wrap=True)
    for period in periods:
        table.add_column(f"{period:g} s", justify="center", no_wrap=True)
    for amplitude in amplitudes:
        cells = [_cell(winners.get((period, amplitude)), schemes) for period in periods]
        table.add_row(f"{amplitude:g} m", *cells)
    return table


def _cell(winner: tuple[str, bool] | None, schemes: Sequence[str]) -> Text:
    from rich.style import Style
    from rich.text import Text

    if winner is None:
        return Text(NO_RESULT)
    name, distinguishable = winner
    look = style_of(name, schemes)
    width = max(len(scheme) for scheme in schemes)
    mark = " " if distinguishable else MARK
    return Text(f" {name:^{width}} {mark}", style=Style(color=look.text_color, bgcolor=look.color))


def _legend(winners: Winners, schemes: Sequence[str]) -> Text:
    from rich.text import Text

    names = [name for name, _ in winners.values()]
    counts = ", ".join(f"{name} {names.count(name)}" for name in schemes if name in names)
    legend = f"cells won: {counts}"
    if not all(distinguishable for _, distinguishable in winners.values()):
        legend += f"; {MARK} not distinguishable from the runner-up"
    return Text(legend)
