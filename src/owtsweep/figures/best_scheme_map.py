"""Draw a map of the best scheme for each combination of values of two conditions.

The map is like Fig. 18 of Ren et al. (2019). In addition, the map tells the error of the best
scheme, names the next best and by how much its error is larger, which the fill shows too, and
hatches the cells in which the data do not show which of the two is better.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from owtsweep.errors import InputError
from owtsweep.figures import margin, style
from owtsweep.figures.margin import add_legend, list_in_legend, make_entry
from owtsweep.figures.palette import style_of, text_color_on
from owtsweep.figures.plane import Plane, Row
from owtsweep.figures.style import Handle
from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import show_error

__all__ = ["draw"]

HATCH = "////"
#: Opacity of the hatch, which has the colour of text on the cell's fill.
HATCH_OPACITY = 0.35
NO_RESULT = "#E4E4E4"
#: What the second name in a cell is.
RUNNER_UP = "Second name in a cell: the runner-up, and by how much its error is larger."
#: Lengths are in inches. A cell lower than `ONE_LINE` has its labels on one line. A map of more
#: than `MOST_LABELS` cells has no labels, and its cells are drawn as pixels, because shapes would
#: make the SVG too large.
CELL_WIDTH = (0.95, 1.6)
CELL_HEIGHT = (0.3, 0.55)
ONE_LINE = 0.42
MOST_LABELS = 600
#: Columns of the legend, and the height of one of its lines in inches.
LEGEND_COLUMNS, LEGEND_LINE = 3, 0.2
#: Height of a letter of the label at the side, and of what stands between legend and footnote
#: beside the cells: the title and the labels of the horizontal axis.
LETTER, TITLE_AND_LABELS = 0.09, 1.1


def draw(
    best: pd.DataFrame,
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    *,
    criterion: str,
    window: str,
    tuning: str,
    quantity: str,
    coinciding: Sequence[Sequence[str]] = (),
    records: str = "",
    failures: int = 0,
    notes: Sequence[str] = (),
) -> Figure:
    """Draw a map of the best scheme in every cell, with title, legend and footnote.

    Raise `InputError` if no row has that criterion and window, or more than two conditions have
    several values.

    best: a run's table best_scheme.csv; rows of `criterion` and `window` are shown.
    schemes: names of all schemes and baselines that the table names, in the order of the legend.
    conditions: the study's conditions; at most two of them may have several values.
    quantity: What the title says the schemes are judged by, with the unit of the errors in cells.
    coinciding: Groups of names of schemes with equal results. The map shows each group under the
        last of its names; legend and footnote say so of the groups that some cell names.
    records: How many records a cell has, in words, for the title.
    failures: Number of failed cases. If it is not 0, title and footnote say that cells may have
        fewer records.
    """
    shown = best[(best["criterion"] == criterion) & (best["window"] == window)]
    if shown.empty:
        raise InputError(f"best: no cell judged by {criterion} in window {window!r} to draw")
    plane = Plane.of(shown, conditions)
    columns, lines = len(plane.columns), len(plane.lines)
    beside = LETTER * max(map(len, plane.side_label.splitlines()), default=0)
    height = max(np.clip(5.5 / lines, *CELL_HEIGHT), beside / lines)
    tall = height >= ONE_LINE
    longest = max(len(name) for name in schemes)
    letters = longest + 8 if tall else 2 * longest + 10
    width = max(np.clip(7.0 / columns, *CELL_WIDTH), 0.1 + 0.065 * letters)

    rows = shown.to_dict("records")
    listed = list_in_legend(rows, schemes)
    cells = height * lines
    figure = style.new_figure(max(7.2, 1.0 + width * columns), cells)
    axes = figure.add_subplot()
    labelled = len(rows) <= MOST_LABELS
    lines_of_text = "lines" if tall else "one line"
    draw_cells(axes, rows, schemes, plane, labels=lines_of_text if labelled else "none")
    counted = f", {'up to ' * (failures > 0)}{records}" if records else ""
    axes.set_title(
        f"Best scheme by {quantity}\n{style.describe_window(window)}, tuning: {tuning}{counted}",
        loc="left",
    )
    named = {*shown["best"], *(shown["runner_up"] if labelled else ())}
    groups = style.choose_groups(coinciding, named)
    handles = _make_legend(rows, listed, groups, holes=len(rows) < plane.size)
    add_legend(figure, handles, columns=LEGEND_COLUMNS)
    explained = _explain(rows, groups, failures, labelled=labelled)
    told = {name for group in groups if group[-1] in listed for name in group}
    unlisted = [name for name in schemes if name not in listed and name not in told]
    beaten = [f"Best in no cell: {', '.join(unlisted)}."] if unlisted else []
    below = style.footnote(figure, " ".join([explained, *beaten, *notes]))
    above = LEGEND_LINE * (1 - (-len(handles) // LEGEND_COLUMNS))
    figure.set_figheight(above + TITLE_AND_LABELS + cells + below)
    return figure


def draw_cells(
    axes: Axes, rows: Sequence[Row], schemes: Sequence[str], plane: Plane, *, labels: str
) -> None:
    """Draw the cells of a map of best schemes, and label the axes.

    rows: the cells: rows of a run's table best_scheme.csv with one criterion and one window.
    schemes: names of all compared schemes, which determine the colours.
    labels: the text in a cell. "lines" and "one line": the best scheme, its error and the next
        best, on lines of their own or, without the error, on one. "best": the best scheme only.
        "none": no text, and the cells are drawn as pixels.
    """
    for row in rows:
        column, number = plane.place(row)
        fill = margin.fill_cell(style_of(row["best"], schemes), margin.ratio_of(row))
        corner = column - 0.5, number - 0.5
        cell: style.Look = {"width": 1.0, "height": 1.0, "rasterized": labels == "none"}
        axes.add_patch(Rectangle(corner, facecolor=fill, edgecolor="white", **cell))
        if row["verdict"] == "open":
            edge = to_rgba(text_color_on(fill), HATCH_OPACITY)
            cell |= {"hatch": HATCH, "edgecolor": edge, "linewidth": 0.0}
            axes.add_patch(Rectangle(corner, fill=False, **cell))
        if labels != "none":
            _label(axes, fill, (column, number), row, labels)
    plane.label_axes(axes)
    axes.set_facecolor(NO_RESULT)
    axes.grid(False)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _label(axes: Axes, fill: str, place: tuple[int, int], row: Row, labels: str) -> None:
    """Write the text that `draw_cells` calls `labels` into the cell at `place`.

    The colour of the cell, `fill`, gives the colour of the text.
    """
    column, line = place
    best, runner_up = row["best"], _describe_runner_up(row)
    box = {"facecolor": fill, "edgecolor": "none", "pad": 1.0}  # hides the hatch behind the letters
    write = partial(axes.text, color=text_color_on(fill), bbox=box, ha="center", va="center")
    if labels == "best":
        write(column, line, best, fontsize=7)
        return
    if row["verdict"] == "tie":
        best = f"{best} ="
    if labels == "one line":
        write(column, line, f"{best} ({runner_up})" if runner_up else best, fontsize=7)
        return
    raised = 0.3 if runner_up else 0.17
    write(column, line + raised, best, fontsize=8.5)
    write(column, line + raised - 0.31, show_error(row["error_best"]), fontsize=7)
    if runner_up:
        write(column, line - 0.31, runner_up, fontsize=6.5)


def _describe_runner_up(row: Row) -> str:
    """Return a cell's next best scheme and by how much its error is larger, e.g. "HME1 +12 %".

    Return "" if there is none, or if the least error is not positive.
    """
    if not row["runner_up"] or not row["error_best"] > 0:
        return ""
    excess = 100.0 * (row["error_runner_up"] / row["error_best"] - 1.0)
    if excess >= 999.5:
        return f"{row['runner_up']} x{excess / 100.0 + 1.0:.0f}"
    return f"{row['runner_up']} {excess:+z.{0 if abs(excess) >= 9.95 else 1}f} %"


def _make_legend(
    rows: Sequence[Row], schemes: Sequence[str], groups: Sequence[Sequence[str]], *, holes: bool
) -> list[Handle]:
    winners = [row["best"] for row in rows]
    handles: list[Handle] = []
    for name in schemes:
        if any(name in group[:-1] for group in groups):
            continue  # shown under the last name of its group
        alike = next((group for group in groups if group[-1] == name), (name,))
        cells = winners.count(name)
        label = f"{' = '.join(alike)} ({cells} cell{'s' * (cells != 1)})"
        handles.append(make_entry(name, schemes, label))
    hatched = any(row["verdict"] == "open" for row in rows)
    return [*handles, *explain_marks(hatched=hatched, holes=holes)]


def explain_marks(*, hatched: bool, holes: bool) -> list[Patch]:
    """Return entries of a map's legend for hatched cells and for cells without a result."""
    marks = []
    if hatched:
        marks.append(Patch(facecolor="0.9", edgecolor="0.5", hatch=HATCH, label="open"))
    if holes:
        marks.append(Patch(facecolor=NO_RESULT, label="no result"))
    return marks


def _explain(
    rows: Sequence[Row], groups: Sequence[Sequence[str]], failures: int, *, labelled: bool
) -> str:
    verdicts = {row["verdict"] for row in rows}
    looked = any(row.get("look", 0) > 0 for row in rows)
    test = "paired differences of all looks" if looked else "paired difference, Holm's correction"
    holds = {
        RUNNER_UP: labelled and any(row["runner_up"] for row in rows),
        "=: a tie; the named scheme is the simplest of several whose errors differ by less than the"
        " margin.": "tie" in verdicts,
        f"Hatched, open: the data do not tell best and runner-up apart ({test}; 95 % over all "
        "cells).": "open" in verdicts,
        **dict.fromkeys(style.explain_coinciding(groups), True),
        f"{failures} case{'s' if failures != 1 else ''} failed; schemes are compared on the"
        " records that all of them finished.": failures > 0,
    }
    return " ".join(sentence for sentence, is_so in holds.items() if is_so)
