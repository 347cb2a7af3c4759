"""Draws how near each scheme comes to the bound: one map of cells per scheme.

The efficiency is bound (b) of `bounds.cells` divided by the scheme's error.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from owtsweep.figures import style
from owtsweep.figures.plane import Plane
from owtsweep.studies.hub.bounds.cells import WINDOW
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import list_baselines, scheme_names
from owtsweep.studies.hub.worlds import CONDITIONS, find_world

NAME = "efficiency"
#: Panels per row, and the most cells of a panel that has numbers in its cells.
PER_ROW, MOST_NUMBERS = 4, 150
#: Ends of the colours, in per cent; a smaller efficiency has the colour of the lower end.
COLOURS = (1.0, 100.0)
#: Above this efficiency, in per cent, the colour is so dark that the number is white.
DARK = 25.0
EXPLANATION = (
    "Efficiency: the least mean square error that any linear estimator can have that knows the "
    "motion's spectrum and its variances along x and y, divided by the scheme's. 100 %: no such "
    "estimator does better; above it: by chance, in few records. It is of the steady state and in "
    "real time."
)


def draw(config: HubConfig, summary: pd.DataFrame, measure: str = "position") -> Figure:
    """Draw the efficiency of schemes and baselines over natural period and amplitude."""
    rows = summary[(summary["window"] == WINDOW) & (summary["measure"] == measure)]
    names = [*scheme_names(config), *list_baselines(config)]
    names = [name for name in names if (rows["scheme"] == name).any()]
    grid = find_world(config).get_grid(config)
    plane = Plane.over(CONDITIONS, {name: sorted(at) for name, at in grid.items()})
    lines = -(-len(names) // PER_ROW)
    columns = min(len(names), PER_ROW)
    figure = style.new_figure(1.6 + 2.5 * columns, 1.4 + lines * (0.9 + 0.26 * len(plane.lines)))
    panels = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True)
    colours = ScalarMappable(LogNorm(*COLOURS), colormaps["Blues"])
    for number, axes in enumerate(panels.flat):
        if number >= len(names):
            axes.remove()
            continue
        _draw_cells(axes, rows[rows["scheme"] == names[number]], plane, colours)
        axes.set_title(style.label_of(names[number]), loc="left")
        axes.label_outer()
        if number + columns >= len(names):
            axes.xaxis.set_tick_params(labelbottom=True)
            axes.set_xlabel(plane.across.title)
    bar = figure.colorbar(colours, ax=figure.axes, extend="min", shrink=0.8)
    bar.set_label("efficiency (%)")
    bar.ax.yaxis.set_major_formatter("{x:g}")
    figure.suptitle(
        f"How near each scheme comes to the bound: {measure}, "
        f"{style.describe_window(WINDOW)}, tuning {config.tuning_name}",
        x=0.01,
        ha="left",
    )
    style.footnote(figure, EXPLANATION)
    return figure


def _draw_cells(axes: Axes, rows: pd.DataFrame, plane: Plane, colours: ScalarMappable) -> None:
    plane.label_axes(axes)
    axes.grid(visible=False)
    for row in rows.to_dict("records"):
        x, y = plane.place(row)
        share = 100.0 * row["efficiency_b"]
        colour = colours.to_rgba(np.array([share]))[0]
        axes.fill([x - 0.5, x + 0.5, x + 0.5, x - 0.5], [y - 0.5, y - 0.5, y + 0.5, y + 0.5],
                  facecolor=colour, edgecolor="white", linewidth=0.5)  # fmt: skip
        if plane.size <= MOST_NUMBERS:
            axes.text(
                x, y, _show(share), ha="center", va="center", fontsize=7,
                color="white" if share > DARK else "black",
            )  # fmt: skip


def _show(share: float) -> str:
    """Write an efficiency in per cent with two digits; "<1" below the end of the colours."""
    if share < COLOURS[0]:
        return f"<{COLOURS[0]:g}"
    return f"{share:.1f}" if share < 9.95 else f"{share:.0f}"
