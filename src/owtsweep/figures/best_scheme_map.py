"""Draw the map of the best scheme in every cell of two conditions, as Fig. 18 of Ren et al. (2019).

Unlike Fig. 18, the map hatches cells where the data do not distinguish the best scheme from the
next best, and it shows by how much the next best is worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import SchemeStyle, style_of
from owtsweep.figures.plane import Plane
from owtsweep.results.conditions import Condition

HATCH = "////"
HATCH_COLOR = (1.0, 1.0, 1.0, 0.6)
NO_RESULT = "#E4E4E4"
#: Lengths are in inches. A cell lower than `ONE_LINE` has its labels on one line. A map of more
#: than `MOST_LABELS` cells has no labels, and its cells are drawn as pixels, because shapes would
#: make the SVG too large.
CELL_WIDTH = (0.95, 1.6)
CELL_HEIGHT = (0.3, 0.55)
ONE_LINE = 0.42
MOST_LABELS = 600


def draw(
    best: pd.DataFrame,
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    *,
    criterion: str,
    window: str,
    tuning: str,
    quantity: str = "",
    coinciding: Sequence[Sequence[str]] = (),
    replicates: int | None = None,
    failures: int = 0,
    notes: Sequence[str] = (),
) -> Figure:
    """Draw the map of the best scheme in every cell, with title, legend and footnote.

    Parameters
    ----------
    best
        The table best_scheme.csv of a run.
    schemes
        All schemes that are named in the table, in the order of the legend.
    conditions
        The study's conditions; at most two of them may have several values.
    criterion, window
        Measure and window of the rows to draw; both are named in the title.
    tuning
        Name of the tuning, for the title.
    quantity
        What the title calls the criterion; "<criterion> MSE" if empty.
    coinciding
        Groups of schemes with equal results (`results.best_scheme.find_coinciding`). The map shows
        each group under the last of its names.
    replicates
        Planned number of records per cell, for the title; None leaves the number out.
    failures
        Number of failed cases. If it is not 0, title and footnote say that cells may have fewer
        records.
    notes
        Sentences at the end of the footnote.

    Raises
    ------
    InputError
        If no row has that criterion and window, or more than two conditions vary.
    """
    shown = best[(best["criterion"] == criterion) & (best["window"] == window)]
    if shown.empty:
        raise InputError(f"best: no cell judged by {criterion} MSE in window {window!r} to draw")
    plane = Plane.of(shown, conditions)
    columns, lines = len(plane.columns), len(plane.lines)
    height = np.clip(5.5 / lines, *CELL_HEIGHT)
    tall = height >= ONE_LINE
    longest = max(len(name) for name in schemes)
    letters = longest + 8 if tall else 2 * longest + 10
    width = max(np.clip(7.0 / columns, *CELL_WIDTH), 0.1 + 0.065 * letters)

    figure = style.new_figure(max(7.2, 1.0 + width * columns), 2.2 + height * lines)
    axes = figure.add_subplot()
    rows = shown.to_dict("records")
    labelled = len(rows) <= MOST_LABELS
    lines_of_text = "two lines" if tall else "one line"
    draw_cells(axes, rows, schemes, plane, labels=lines_of_text if labelled else "none")
    axes.set_title(
        f"Best scheme by {quantity or f'{criterion} MSE'}\n{style.describe_window(window)}, "
        f"tuning: {tuning}{_count_records(replicates, failures)}",
        loc="left",
    )
    handles = _make_legend(rows, schemes, coinciding, holes=len(rows) < plane.size)
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    explained = _explain(rows, coinciding, failures, labelled=labelled)
    style.footnote(figure, " ".join([explained, *notes]))
    return figure


def draw_cells(
    axes: Axes,
    rows: Sequence[dict[Any, Any]],
    schemes: Sequence[str],
    plane: Plane,
    *,
    labels: str,
) -> None:
    """Draw the cells of a map.

    Parameters
    ----------
    rows
        Rows of best_scheme.csv with one criterion and one window.
    schemes
        All schemes compared.
    plane
        The axes of the map.
    labels
        The text in a cell. "two lines" and "one line": the best scheme and the next best. "best":
        the best scheme only. "none": no text, and the cells are drawn as pixels.
    """
    for row in rows:
        column, line = plane.place(row)
        look, corner = style_of(row["best"], schemes), (column - 0.5, line - 0.5)
        cell: dict[str, Any] = {"width": 1.0, "height": 1.0, "rasterized": labels == "none"}
        axes.add_patch(Rectangle(corner, facecolor=look.color, edgecolor="white", **cell))
        if not row["distinguishable"]:
            cell |= {"hatch": HATCH, "edgecolor": HATCH_COLOR, "linewidth": 0.0}
            axes.add_patch(Rectangle(corner, fill=False, **cell))
        if labels != "none":
            runner_up = "" if labels == "best" else _describe_runner_up(row)
            _label(axes, look, (column, line), (row["best"], runner_up), tall=labels == "two lines")
    plane.label_axes(axes)
    axes.set_facecolor(NO_RESULT)
    axes.grid(False)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _label(
    axes: Axes, look: SchemeStyle, place: tuple[int, int], names: tuple[str, str], *, tall: bool
) -> None:
    """Write two texts into a cell: the best scheme and the next best, which may be ""."""
    column, line = place
    best, runner_up = names
    # the box hides the hatch behind the letters
    box = {"facecolor": look.color, "edgecolor": "none", "pad": 1.0}
    text: dict[str, Any] = {"color": look.text_color, "bbox": box, "ha": "center", "va": "center"}
    if not tall:
        both = f"{best} ({runner_up})" if runner_up else best
        axes.text(column, line, both, fontsize=7, **text)
        return
    axes.text(column, line + (0.2 if runner_up else 0.0), best, fontsize=9.5, **text)
    if runner_up:
        axes.text(column, line - 0.23, runner_up, fontsize=7, **text)


def _describe_runner_up(row: dict[Any, Any]) -> str:
    """Name the next best scheme of a cell, and by how much its MSE is larger, e.g. "HME1 +12 %".

    Returns "" if there is no next best scheme, or if the best scheme's MSE is not positive.
    """
    if not row["runner_up"] or not row["mse_best"] > 0:
        return ""
    excess = max(100.0 * row["difference"] / row["mse_best"], 0.0)
    return f"{row['runner_up']} +{excess:.{0 if excess >= 9.95 else 1}f} %"


def _count_records(replicates: int | None, failures: int) -> str:
    if replicates is None:
        return ""
    count = f"{replicates} record{'s' if replicates != 1 else ''} per cell"
    return f", up to {count}" if failures else f", {count}"


def _make_legend(
    rows: Sequence[dict[Any, Any]],
    schemes: Sequence[str],
    groups: Sequence[Sequence[str]],
    *,
    holes: bool,
) -> list[Patch]:
    winners = [row["best"] for row in rows]
    handles = []
    for name in schemes:
        if any(name in group[:-1] for group in groups):
            continue  # shown under the last name of its group
        alike = next((group for group in groups if group[-1] == name), (name,))
        cells = winners.count(name)
        label = f"{' = '.join(alike)} ({cells} cell{'s' * (cells != 1)})"
        look = style_of(name, schemes)
        handles.append(Patch(facecolor=look.color, label=style.label_of(label)))
    hatched = not all(row["distinguishable"] for row in rows)
    return handles + explain_marks(hatched=hatched, holes=holes)


def explain_marks(*, hatched: bool, holes: bool) -> list[Patch]:
    """Make the legend's entries for hatched cells and for cells without a result, where present."""
    marks = []
    if hatched:
        look: dict[str, Any] = {"facecolor": "0.6", "edgecolor": "white", "hatch": HATCH}
        marks.append(Patch(label="not distinguishable", **look))
    if holes:
        marks.append(Patch(facecolor=NO_RESULT, label="no result"))
    return marks


def _explain(
    rows: Sequence[dict[Any, Any]],
    groups: Sequence[Sequence[str]],
    failures: int,
    *,
    labelled: bool,
) -> str:
    sentences = []
    if labelled and any(row["runner_up"] for row in rows):
        sentences.append(
            "Second name in a cell: the next best scheme and by how much its MSE is larger."
        )
    if not all(row["distinguishable"] for row in rows):
        sentences.append(
            "Hatched: the data do not tell best and next best apart"
            " (paired difference, 95 %, Holm's correction over all cells)."
        )
    sentences += style.explain_coinciding(groups)
    if failures:
        sentences.append(
            f"{failures} case{'s' if failures != 1 else ''} failed; schemes are compared on the"
            " records that all of them finished."
        )
    return " ".join(sentences)
