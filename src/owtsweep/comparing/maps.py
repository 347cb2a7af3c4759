"""Draw maps of the best scheme of several runs side by side, with a boundary of two schemes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from owtsweep.comparing.common import Judged
from owtsweep.comparing.comparison import Aspects, Comparison
from owtsweep.figures import margin, style
from owtsweep.figures.best_scheme_map import draw_cells, explain_marks
from owtsweep.figures.margin import list_shades
from owtsweep.figures.plane import Plane

#: Greatest number of panels in a figure; number of panels in a row if the runs differ in one key.
MOST_PANELS = 30
WRAP = 4
#: `panels[row][column]` is the index of a run or None.
Panels = list[list[int | None]]


def arrange(comparison: Comparison) -> Panels | None:
    """Assign a panel of a figure to every run, row by row; None for an empty panel.

    If the runs differ in two keys, each value of the first key has a column of panels, and each
    value of the second key has a row. If they differ in one key, they fill rows of `WRAP` panels.
    Return None if they differ in more than two keys, or there would be more than `MOST_PANELS`
    panels.
    """
    keys, count = comparison.keys, len(comparison.runs)
    if len(keys) > 2 or count > MOST_PANELS:
        return None
    if len(keys) == 1:
        across = [index % WRAP for index in range(count)]
        down = [index // WRAP for index in range(count)]
    else:
        across, down = (comparison.rank(key) for key in keys)
    columns, rows = max(across) + 1, max(down) + 1
    if columns * rows > MOST_PANELS:
        return None
    panels: Panels = [[None] * columns for _ in range(rows)]
    for index, (column, row) in enumerate(zip(across, down, strict=True)):
        panels[row][column] = index
    return panels


def draw(
    panels: Panels, runs: Sequence[Judged], shared: Aspects, plane: Plane, *, subtitle: str
) -> Figure:
    """Draw a map of the best scheme for each run, one run per panel, with its boundary if any.

    panels: row by row, the index in `runs` of the run in each panel; None for an empty panel.
    runs: the results of the runs, which differ in one or two keys.
    plane: the axes of each map.
    subtitle: the end of the title, which says by what the schemes are judged.
    """
    rows, columns = len(panels), len(panels[0])
    width = min(max(2.9, 0.5 * len(plane.columns)), 5.0)
    height = min(max(2.1, 0.27 * len(plane.lines)), 4.0)
    with style.context():
        figure = style.new_figure(max(7.6, 0.9 + width * columns), 1.9 + (height + 0.5) * rows)
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        hatched = holes = line = False
        for (row, column), axes in np.ndenumerate(grid):
            index = panels[row][column]
            if index is None:
                text = "no run" if len(runs[0].run.values) > 1 else ""
                axes.set_axis_off()
                axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color="0.4")
                continue
            judged = runs[index]
            cells = judged.best.to_dict("records")
            draw_cells(axes, cells, shared.schemes, plane, labels="none")
            title = "\n".join(f"{key} = {text}" for key, text in judged.run.shown.items())
            axes.set_title(title, loc="left", fontsize=9)
            axes.label_outer()
            hatched |= not all(cell["distinguishable"] for cell in cells)
            holes |= len(cells) < shared.size
            line |= _draw_boundary(axes, judged.boundaries, plane)
        for row, indices in enumerate(panels):
            leftmost = next(c for c, index in enumerate(indices) if index is not None)
            grid[row][leftmost].tick_params(labelleft=True)
            grid[row][leftmost].set_ylabel(plane.upwards.title if plane.upwards else "")
        for column in range(columns):
            lowest = max(row for row in range(rows) if panels[row][column] is not None)
            grid[lowest][column].tick_params(labelbottom=True)
            grid[lowest][column].set_xlabel(plane.across.title)
        handles = list_shades(shared.schemes, shared.schemes)
        handles += explain_marks(hatched=hatched, holes=holes)
        if line:
            label = f"{'/'.join(shared.boundary or ())} boundary"
            handles += _plot_line(grid[0][0], [], label=label)
        style.add_legend_above(figure, handles, f"Best scheme {subtitle}", 4)
        style.footnote(figure, _explain(shared, plane, hatched=hatched, line=line))
    return figure


def _draw_boundary(axes: Axes, boundaries: pd.DataFrame | None, plane: Plane) -> bool:
    """Draw the boundary of two schemes into a map; return whether anything was drawn.

    Nothing is, unless the map's vertical axis is the condition in which the boundary is measured.
    """
    if boundaries is None or plane.upwards is None or not plane.upwards.expands:
        return False
    exists = boundaries[(boundaries["wins"] == "") & boundaries["boundary"].notna()]
    if exists.empty:
        return False
    # A line across a value without a boundary would suggest a boundary there.
    line = [float("nan")] * len(plane.columns)
    heights = plane.height_of(exists["boundary"].to_numpy(dtype=float))
    for value, height in zip(exists[plane.across.name], heights, strict=True):
        line[plane.columns.index(value)] = float(height)
    _plot_line(axes, line, color="white", width=3.6)
    _plot_line(axes, line)
    return True


def _plot_line(
    axes: Axes, line: Sequence[float], *, color: str = "black", width: float = 1.6, label: str = ""
) -> list[Line2D]:
    return axes.plot(
        range(len(line)), line, color=color, linewidth=width, marker="o", markersize=3.5,
        markeredgecolor="white", markeredgewidth=0.6, zorder=5, label=label or None,
    )  # fmt: skip


def _explain(shared: Aspects, plane: Plane, *, hatched: bool, line: bool) -> str:
    parts = [margin.EXPLANATION] if len(shared.schemes) > 1 else []
    if hatched:
        parts.append(
            "Hatched: the data do not tell best and runner-up apart (paired difference, 95 %,"
            " Holm's correction over the cells of one map)."
        )
    if shared.beside:
        parts.append(
            "Best of the schemes, also where a baseline has less error: baselines take no part."
        )
    if line and shared.boundary and plane.upwards:
        how = "logarithmically" if plane.upwards.scale == "log" else "linearly"
        parts.append(
            f"Boundary: {plane.upwards.word} at which {' and '.join(shared.boundary)} have the same"
            f" mean MSE, placed {how} between rows and at the map's edge if it lies beyond;"
            f" {plane.across.values_word} without a point have no boundary."
        )
    return " ".join(parts) or "Every cell's best scheme is told from the next."
