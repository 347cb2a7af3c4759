"""Draws what an IMU that leans with the tower costs each scheme, and what knowing it saves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.studies.hub.tilt_cost import KNOWLEDGE

if TYPE_CHECKING:
    import pandas as pd

#: Knowledge -> title of its panel. The panels of a tilt that is 20 % wrong show the larger error.
PANELS = {
    "level": "level IMU",
    "unknown": "it leans, nobody knows",
    "20 %": "it leans, known to 20 %",
    "known": "it leans, known exactly",
}


def draw(costs: pd.DataFrame, *, title: str, origin: str) -> Figure:
    """Draw each scheme's root of the settled MSE over the natural period, one panel per knowledge.

    Parameters
    ----------
    costs
        The table of `tilt_cost.compare_knowledge`.
    title, origin
        Title of the figure, and the text on the truth and the tuning below it.
    """
    amplitudes = sorted(costs["amplitude"].unique())
    figure = style.new_figure(13.0, 1.0 + 3.4 * len(amplitudes))
    grid = figure.subplots(len(amplitudes), len(PANELS), sharex=True, sharey="row", squeeze=False)
    for row, amplitude in zip(grid, amplitudes, strict=True):
        for axes, knowledge in zip(row, PANELS, strict=True):
            meant = [name for name in KNOWLEDGE if name.startswith(knowledge)]
            chosen = costs["knowledge"].isin(meant) & (costs["amplitude"] == amplitude)
            _draw_panel(axes, costs[chosen])
        largest = costs[costs["amplitude"] == amplitude]["mse_position"].max()
        row[0].set_ylim(0.0, 1.05 * np.sqrt(largest))
        row[0].set_ylabel(f"amplitude {amplitude:g} m\nposition error, rms of x + y (m)")
    for axes, head in zip(grid[0], PANELS.values(), strict=True):
        axes.set_title(head, fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("natural period (s)")
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False)
    style.footnote(figure, origin)
    return figure


def _draw_panel(axes: Axes, part: pd.DataFrame) -> None:
    """Draw the errors of one panel; of several rows of a scheme and a period the largest."""
    schemes = list(dict.fromkeys(part["scheme"]))
    for name in schemes:
        error = part[part["scheme"] == name].groupby("natural_period")["mse_position"].max()
        look = style_of(name, schemes)
        axes.plot(
            error.index, np.sqrt(error), color=look.color, linestyle=look.line, marker=look.marker,
            label=name,
        )  # fmt: skip
    bound = part.groupby("natural_period")["bound_position"].max()
    axes.plot(
        bound.index, np.sqrt(bound), color="0.35", linewidth=1.2, linestyle=(0, (1, 1)),
        label="bound, tilt known",
    )  # fmt: skip
