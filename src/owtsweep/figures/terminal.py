"""Make the map of best schemes that the command `sweep` prints in the terminal at its end.

The map is understood without colours: a name or a letter stands in each cell, and a mark after it
marks what the data do not distinguish.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from string import ascii_uppercase

import pandas as pd
from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.style import Style
from rich.table import Table
from rich.text import Text

from owtsweep.figures import margin
from owtsweep.figures.palette import style_of, text_color_on
from owtsweep.figures.plane import Plane, Row
from owtsweep.io.terminal import break_columns
from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import show_error

__all__ = ["grid"]

#: Verdict -> mark after a scheme's name in a cell.
MARKS = {"won": " ", "tie": "=", "open": "~"}
MEANINGS = {
    "tie": "= tie: the simplest of several within the margin",
    "open": "~ open: the data do not tell the best and the next best apart",
}
NO_RESULT = "-"
#: A longer name is broken after an underscore. If that does not do, a letter stands for it.
LONGEST_LINE = 10
#: What `Console.color_system` says of a terminal -> whether the map shows the margin by shades.
#: With 256 colours, pale shades of two schemes become one colour, so there all cells are full. The
#: 8 or 16 colours of other terminals are those of the user's theme, on which text may be
#: unreadable: there, the map has no colour.
SHADED = {"truecolor": True, "256": False}


def frame(origin: Sequence[str], shown: RenderableType, lines: Sequence[str]) -> RenderableType:
    """Return lines on the origin of a map, bold, the map, and lines that tell what it shows."""
    return Group(
        *(Text(line, style="bold") for line in origin), shown, *(Text(line) for line in lines)
    )


def grid(
    best: pd.DataFrame,
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    criterion: str,
    window: str,
    *,
    quantity: str = "",
    unit: str = "",
    notes: Sequence[str] = (),
) -> RenderableType:
    """Make a map of the best schemes for the terminal, as tables of names with a legend.

    The first condition runs from left to right, the second from bottom to top. There is one map for
    each combination of values of further conditions. If no row of `best` has the criterion and the
    window, return a sentence that says so.

    best: a run's table best_scheme.csv, one row per cell, criterion and window.
    schemes: names of all schemes and baselines that the table names; they determine the colours.
    quantity, unit: What schemes are judged by, in words, and the unit of the errors in the cells.
    """
    shown = best[(best["criterion"] == criterion) & (best["window"] == window)]
    if shown.empty:
        return Text(f"No cell to compare by {criterion} ({window} record).")
    below = f"; below it the error{f' in {unit}' if unit else ''}" * ("error_best" in shown)
    parts: list[RenderableType] = [
        Text(f"Best scheme by {quantity or criterion}, {window} record{below}", style="bold")
    ]
    axes = zip(("Across", "upwards"), conditions[:2], strict=False)
    parts.append(Text("; ".join(f"{where}: {condition.label}" for where, condition in axes)))
    winners = set(shown["best"])
    signs = _choose_signs([name for name in schemes if name in winners])
    further = conditions[2:]
    names = [condition.name for condition in further]
    groups = [cells for _, cells in shown.groupby(names, sort=False)] if names else [shown]
    holes = False
    for cells in groups:
        if further:
            words = (f"{c.word} {c.show(cells[c.name].iloc[0])}" for c in further)
            parts.append(Text(", ".join(words)))
        plane = Plane.of(cells, conditions[:2])
        rows = {plane.place(row): row for row in cells.to_dict("records")}
        headers = [plane.across.show(value) for value in plane.columns]
        beside, labels = "", [""]
        if plane.upwards:
            beside, labels = plane.upwards.word, [plane.upwards.show(v) for v in plane.lines]
        parts.append(_Map(rows, schemes, signs, headers, labels, beside))
        holes |= len(rows) < plane.size
    parts += [_make_legend(shown, schemes, signs, holes=holes), _Explanation()]
    parts += [Text(note) for note in notes]
    return Group(*parts)


def _choose_signs(schemes: Sequence[str]) -> dict[str, list[str]]:
    """Return scheme -> lines that stand for it in a cell: its name, or a letter if it is long."""
    every = (f"{ascii_uppercase[n % 26]}{n // 26 or ''}" for n in count())
    letters = (letter for letter in every if letter not in schemes)
    return {name: _break_name(name) or [next(letters)] for name in schemes}


def _break_name(name: str) -> list[str]:
    """Return a name as one or two short lines; empty if it is too long for that."""
    if cell_len(name) <= LONGEST_LINE:
        return [name]
    ends = [end for end, letter in enumerate(name, start=1) if letter == "_"]
    pairs = [[name[:end], name[end:]] for end in ends]
    return next((pair for pair in pairs if max(map(cell_len, pair)) <= LONGEST_LINE), [])


@dataclass(frozen=True)
class _Map:
    """The cells of one map; the width and the colours are chosen when it is printed.

    rows: (column, line) of a cell -> its row of best_scheme.csv.
    signs: scheme that is best in some cell -> the lines that stand for it there.
    headers, labels, beside: the texts above the columns, beside the lines, and above the latter.
    """

    rows: Mapping[tuple[int, int], Row]
    schemes: Sequence[str]
    signs: Mapping[str, list[str]]
    headers: list[str]
    labels: list[str]
    beside: str

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield tables that are as wide as fits; what is left continues in a table below."""
        shaded = SHADED.get(console.color_system or "")
        outer, widths = self._measure()
        cells = {
            (column, line): self._make_cell(row, shaded, widths[column])
            for (column, line), row in self.rows.items()
        }
        for _, *columns in break_columns([outer, *widths], options.max_width, gap=1):
            yield self._make_table(cells, [column - 1 for column in columns])

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        outer, widths = self._measure()
        most = outer + sum(widths) + len(widths)
        return Measurement(outer + max(widths) + 1, most).with_maximum(options.max_width)

    def _measure(self) -> tuple[int, list[int]]:
        """Return the widths of the labels and of each column of cells."""
        outer = max(map(cell_len, [self.beside, *self.labels])) + 2
        return outer, [max(cell_len(shown), self._sign_width() + 3) for shown in self.headers]

    def _sign_width(self) -> int:
        return max(cell_len(line) for lines in self.signs.values() for line in lines)

    def _make_table(self, cells: Mapping[tuple[int, int], Text], columns: Sequence[int]) -> Table:
        table = Table(box=box.SIMPLE, padding=0, header_style="")
        table.add_column(Text(self.beside), justify="right", overflow="fold")
        for column in columns:
            table.add_column(Text(self.headers[column], justify="center"), overflow="fold")
        hole = Text(NO_RESULT, justify="center")
        for line in reversed(range(len(self.labels))):
            texts = [cells.get((column, line), hole) for column in columns]
            table.add_row(Text(self.labels[line]), *texts)
        return table

    def _make_cell(self, row: Row, shaded: bool | None, wide: int) -> Text:
        """Make the text of a cell; `shaded` is None for a cell without colour."""
        width, height = self._sign_width(), max(map(len, self.signs.values()))
        sign = self.signs[row["best"]]
        lines = [f" {line:^{width}}  " for line in sign]
        lines[0] = lines[0][:-1] + MARKS[row["verdict"]]
        if "error_best" in row:
            lines.append(show_error(row["error_best"]))
        lines += [""] * (height - len(sign))  # a cell is filled to its end
        text = "\n".join(line.center(wide) for line in lines)
        if shaded is None:
            return Text(text)
        look = style_of(row["best"], self.schemes)
        fill = margin.fill_cell(look, margin.ratio_of(row)) if shaded else look.color
        return Text(text, style=Style(color=text_color_on(fill), bgcolor=fill))


class _Explanation:
    """The sentence that explains the shades, printed only where the map has shades."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        if SHADED.get(console.color_system or "") and not console.no_color:
            yield Text(margin.EXPLANATION)


def _make_legend(
    best: pd.DataFrame, schemes: Sequence[str], signs: Mapping[str, list[str]], *, holes: bool
) -> Text:
    names = best["best"].to_list()
    counts = ", ".join(
        f"{name if ''.join(signs[name]) == name else f'{signs[name][0]} = {name}'} "
        f"{names.count(name)}"
        for name in schemes
        if name in names
    )
    legend = f"cells: {counts}"
    for verdict, meaning in MEANINGS.items():
        if (best["verdict"] == verdict).any():
            legend += f"; {meaning}"
    if holes:
        legend += f"; {NO_RESULT} no result"
    return Text(legend)
