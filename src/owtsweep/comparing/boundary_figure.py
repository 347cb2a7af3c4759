"""Draw how the boundary between two schemes depends on a swept configuration key."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator

from owtsweep.comparing.comparison import Aspects, Comparison
from owtsweep.config.section import unit_of
from owtsweep.figures import style
from owtsweep.results.conditions import Condition

MARKERS = "osD^vP*X"
#: The vertical axis may extend beyond the condition's values by this factor. A boundary farther out
#: would be an extrapolation.
BEYOND = 4.0


def draw(
    boundaries: pd.DataFrame, comparison: Comparison, shared: Aspects, *, subtitle: str
) -> Figure:
    """Draw the boundary between two schemes against the first swept key, one line per cell.

    If the runs differ in a second key, each of its values has its own panel. The vertical axis is
    the last condition; a boundary far outside the run's values of it is a hollow mark at the end of
    the axis.

    boundaries: one row per run and cell, as from `results.boundary.find_boundary`, with a further
        column `index`: the index of the run in `comparison.runs`. In at least one row a boundary
        exists.
    comparison: the runs, which differ in one or two keys.
    subtitle: the end of the title, which says by what the schemes are judged.
    """
    keys = comparison.keys
    across = comparison.rank(keys[0])
    down = comparison.rank(keys[1]) if len(keys) == 2 else [0] * len(across)
    labels = {place: run.shown[keys[0]] for place, run in zip(across, comparison.runs, strict=True)}
    with style.context():
        count = max(down) + 1
        figure = style.new_figure(max(6.8, min(1.0 + 3.4 * count, 16.0)), 4.9)
        grid = figure.subplots(1, count, squeeze=False, sharey=True, sharex=True)[0]
        *outer, expanded = shared.conditions
        cells = _list_cells(boundaries, outer)
        ends = boundaries[["boundary", "ci_low", "ci_high"]].to_numpy(dtype=float)
        values = [float(value) for value in shared.grid[expanded.name]]
        edges = (min(values) / BEYOND, max(values) * BEYOND)
        ends = np.clip(ends[np.isfinite(ends) & (ends > 0.0)], *edges)
        narrow = bool(ends.max() < 8.0 * ends.min())  # too few round values on a log scale
        unit = unit_of(type(comparison.runs[0].config), keys[0])
        numeric = all(isinstance(run.values[keys[0]], int | float) for run in comparison.runs)
        for number, axes in enumerate(grid):
            places = {index: across[index] for index, row in enumerate(down) if row == number}
            _draw_panel(axes, places, cells, edges, joined=numeric)
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(
                MaxNLocator(6) if narrow else LogLocator(subs=(1.0, 2.0, 5.0))
            )
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
            _say_why_empty(axes, boundaries, places, expanded)
            axes.set_xticks(list(labels), list(labels.values()))
            axes.set_xlim(-0.5, len(labels) - 0.5)
            axes.set_xlabel(f"{keys[0]} ({unit})" if unit else keys[0])
            if len(keys) == 2:
                text = comparison.runs[down.index(number)].shown[keys[1]]
                axes.set_title(f"{keys[1]} = {text}", loc="left", fontsize=9)
        of_boundary = f" ({expanded.unit})" if expanded.unit else ""
        grid[0].set_ylabel(f"{expanded.word} of the boundary{of_boundary}")
        title = f"{'/'.join(shared.boundary or ())} boundary {subtitle}"
        title += "".join(f"; {condition.label}:" for condition in outer)
        handles, _ = grid[0].get_legend_handles_labels()
        style.add_legend_above(figure, handles, title, columns=min(len(handles), 8))
        style.footnote(figure, _explain(boundaries, shared, edges))
    return figure


def _list_cells(boundaries: pd.DataFrame, outer: Sequence[Condition]) -> dict[str, pd.DataFrame]:
    """Return the cell's name in the legend -> its rows; a cell is one value of each of `outer`."""
    names = [condition.name for condition in outer]
    groups = boundaries.groupby(names) if names else [((), boundaries)]
    return {
        ", ".join(
            condition.show(value)
            for condition, value in zip(outer, rows[names].iloc[0], strict=True)
        ): rows
        for _, rows in groups
    }


def _draw_panel(
    axes: Axes,
    places: dict[int, int],
    cells: Mapping[str, pd.DataFrame],
    edges: tuple[float, float],
    *,
    joined: bool,
) -> None:
    colors = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, max(len(cells), 2)))
    width = 0.5 / max(len(cells), 1)
    for number, (name, rows) in enumerate(cells.items()):
        exists = rows[rows["wins"] == ""].set_index("index")
        ends = exists[["boundary", "ci_low", "ci_high"]].reindex(list(places))
        line, lows, highs = ends.to_numpy(dtype=float).T
        # Shifted sideways, so that the intervals do not hide each other.
        x = [place + (number - 0.5 * (len(cells) - 1)) * width for place in places.values()]
        color, marker = colors[number], MARKERS[number % len(MARKERS)]
        intervals = np.where(np.isfinite(lows + highs), np.clip([lows, highs], *edges), np.nan)
        axes.vlines(x, *intervals, linewidth=1.2, color=color, zorder=3)
        drawn = np.clip(line, *edges)
        dashes, label = "-" if joined else "none", style.label_of(name)
        mark: style.Look = {"color": color, "zorder": 3, "marker": marker, "markersize": 5}
        axes.plot(x, drawn, linewidth=1.4, linestyle=dashes, label=label, **mark)
        outside = np.where(drawn == line, np.nan, drawn)
        axes.plot(x, outside, linestyle="none", markerfacecolor="white", **mark)


def _say_why_empty(
    axes: Axes, boundaries: pd.DataFrame, places: dict[int, int], expanded: Condition
) -> None:
    """Write into a panel why there is no boundary: once, or for each run without one.

    `places` maps the index of each run of this panel to its place on the horizontal axis.
    """
    in_panel = boundaries[boundaries["index"].isin(list(places))]
    if not (in_panel["wins"] == "").any():
        text = f"no boundary:\n{_explain_absence(in_panel, expanded)}"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", fontsize=9)
        return
    for index, place in places.items():
        of_run = in_panel[in_panel["index"] == index]
        if not (of_run["wins"] == "").any():
            why = _explain_absence(of_run, expanded).replace(" at ", "\nat ")
            axes.text(place, 0.5, f"no boundary:\n{why}", transform=axes.get_xaxis_transform(),
                      ha="center", va="center", fontsize=8)  # fmt: skip


def _explain_absence(boundaries: pd.DataFrame, expanded: Condition) -> str:
    winners = sorted(set(boundaries["wins"]))
    if not winners:
        return "not known"
    if "neither" in winners:
        return "they do not change places once"
    return f"{winners[0] if len(winners) == 1 else 'one'} is better at every {expanded.word}"


def _explain(boundaries: pd.DataFrame, shared: Aspects, edges: tuple[float, float]) -> str:
    lower, upper = shared.boundary or ("", "")
    expanded = shared.conditions[-1]
    text = (
        f"Below the boundary {lower} has the smaller mean MSE of the two, above it {upper}; bars:"
        " 95 % interval (bootstrap over the records), left out where an end is infinite. Points of"
        " one tick are shifted sideways, so that their bars do not hide each other."
    )
    exists = boundaries.loc[boundaries["wins"] == "", "boundary"]
    if not exists.between(*edges).all():
        text += (
            f" Hollow: beyond {edges[0]:.2g}-{edges[1]:.2g} {expanded.unit}, far outside the swept"
            f" {expanded.values_word}; boundaries.csv has the value."
        )
    missing = boundaries[boundaries["wins"] != ""]
    if len(missing):
        text += (
            f" {len(missing)} of {len(boundaries)} boundaries do not exist (no point):"
            " boundaries.csv names the better scheme there."
        )
    return text
