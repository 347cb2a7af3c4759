"""How the HME1/HME2 boundary moves with a swept key."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.figures import style
from owtsweep.studies.hub.figures.two_maps import LOWER, UPPER
from owtsweep.sweep.comparison import Comparison
from owtsweep.sweep.swept import ranks, show

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKERS = "osD^vP*X"
#: How far beyond the swept amplitudes the axis reaches: farther out a boundary is an extrapolation.
BEYOND = 4.0


def draw(
    boundaries: pd.DataFrame,
    comparison: Comparison,
    *,
    amplitudes: Sequence[float],
    subtitle: str,
) -> Figure:
    """Draw the boundary over the first key, one line per natural period, one panel per second key.

    Parameters
    ----------
    boundaries
        The table of boundaries with the run's `index`; at least one exists.
    comparison
        The runs, told apart by one or two keys.
    amplitudes
        The swept ones, m: boundaries far outside of them are drawn at the edge, hollow.
    subtitle
        What is judged.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator

    keys = comparison.keys
    across = ranks([run.values[keys[0]] for run in comparison.runs])
    labels = {place: show(run.values[keys[0]]) for place, run in zip(across, comparison.runs,
              strict=True)}  # fmt: skip
    down = ranks([run.values[keys[1]] for run in comparison.runs]) if len(keys) == 2 else None
    groups = [
        [i for i in range(len(comparison.runs)) if down is None or down[i] == number]
        for number in range(1 if down is None else max(down) + 1)
    ]
    with style.context():
        count = len(groups)
        figure = style.new_figure(max(6.8, min(1.0 + 3.4 * count, 16.0)), 4.9)
        grid = figure.subplots(1, count, squeeze=False, sharey=True, sharex=True)[0]
        periods = sorted(set(boundaries["natural_period"]))
        ends = boundaries[["boundary", "ci_low", "ci_high"]].to_numpy(dtype=float)
        edges = (min(amplitudes) / BEYOND, max(amplitudes) * BEYOND)
        ends = np.clip(ends[np.isfinite(ends) & (ends > 0.0)], *edges)
        narrow = bool(ends.max() < 8.0 * ends.min())  # too few round values on a log scale
        numeric = all(isinstance(run.values[keys[0]], int | float) for run in comparison.runs)
        for axes, group in zip(grid, groups, strict=True):
            _panel(axes, boundaries, {i: across[i] for i in group}, periods, edges, joined=numeric)
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(
                MaxNLocator(6) if narrow else LogLocator(subs=(1.0, 2.0, 5.0))
            )
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
            _say_why_empty(
                axes, boundaries[boundaries["index"].isin(group)], {i: across[i] for i in group}
            )
            axes.set_xticks(range(len(labels)), [labels[i] for i in range(len(labels))])
            axes.set_xlim(-0.5, len(labels) - 0.5)
            axes.set_xlabel(keys[0])
            if down is not None:
                value = show(comparison.runs[group[0]].values[keys[1]])
                axes.set_title(f"{keys[1]} = {value}", loc="left", fontsize=9)
        grid[0].set_ylabel("amplitude of the boundary (m)")
        handles, names = grid[0].get_legend_handles_labels()
        figure.legend(
            handles,
            names,
            title=f"{LOWER}/{UPPER} boundary {subtitle}; natural period:",
            title_fontsize=11,
            loc="outside upper left",
            alignment="left",
            ncols=min(len(names), 8),
            frameon=False,
        )
        style.footnote(figure, _explanation(boundaries, edges))
    return figure


def _panel(
    axes: Axes,
    boundaries: pd.DataFrame,
    places: dict[int, int],
    periods: Sequence[float],
    edges: tuple[float, float],
    *,
    joined: bool,
) -> None:
    import matplotlib as mpl

    colors = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, max(len(periods), 2)))
    width = 0.5 / max(len(periods), 1)
    for number, period in enumerate(periods):
        own = boundaries[(boundaries["natural_period"] == period) & (boundaries["wins"] == "")]
        ends = {
            int(index): (float(value), float(low), float(high))
            for index, value, low, high in zip(
                *(own[name] for name in ("index", "boundary", "ci_low", "ci_high")), strict=True
            )
        }
        x, line = [], []
        look: dict[str, Any] = {"color": colors[number], "zorder": 3}
        for index, place in sorted(places.items(), key=lambda item: item[1]):
            # Side by side, or the intervals would hide each other.
            x.append(place + (number - 0.5 * (len(periods) - 1)) * width)
            value, low, high = ends.get(index, (np.nan, np.nan, np.nan))
            line.append(value)
            if np.isfinite(low + high):
                axes.vlines(x[-1], *np.clip([low, high], *edges), linewidth=1.2, **look)
        look |= {"marker": MARKERS[number % len(MARKERS)], "markersize": 5}
        drawn = np.clip(line, *edges)
        style_of_line = "-" if joined else "none"
        axes.plot(x, drawn, linewidth=1.4, linestyle=style_of_line, label=f"{period:g} s", **look)
        outside = np.where(drawn == line, np.nan, drawn)
        axes.plot(x, outside, linestyle="none", markerfacecolor="white", **look)


def _say_why_empty(axes: Axes, found: pd.DataFrame, places: dict[int, int]) -> None:
    """Where no natural period has a boundary, say so; one message if that is the whole panel."""
    if not (found["wins"] == "").any():
        text = f"no boundary:\n{_why(found)}"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", fontsize=9)
        return
    for index, place in places.items():
        own = found[found["index"] == index]
        if not (own["wins"] == "").any():
            text = "no boundary:\n" + _why(own).replace(" at ", "\nat ")
            axes.text(place, 0.5, text, transform=axes.get_xaxis_transform(), ha="center",
                      va="center", fontsize=8)  # fmt: skip


def _why(found: pd.DataFrame) -> str:
    winners = sorted(set(found["wins"]))
    if not winners:
        return "not known"
    if "neither" in winners:
        return "they do not change places once"
    if len(winners) > 1:
        return "one is better at every amplitude"
    return f"{winners[0]} is better at every amplitude"


def _explanation(boundaries: pd.DataFrame, edges: tuple[float, float]) -> str:
    text = (
        f"Below the boundary {LOWER} has the smaller mean MSE of the two, above it {UPPER}; bars:"
        " 95 % interval (bootstrap over the records), left out where an end is infinite. Points of"
        " one value stand side by side."
    )
    exists = boundaries.loc[boundaries["wins"] == "", "boundary"]
    if not exists.between(*edges).all():
        text += (
            f" Hollow: beyond {edges[0]:.2g}-{edges[1]:.2g} m, far outside the swept amplitudes;"
            " boundaries.csv has the value."
        )
    missing = boundaries[boundaries["wins"] != ""]
    if len(missing):
        text += (
            f" {len(missing)} of {len(boundaries)} boundaries do not exist (no point):"
            " boundaries.csv names the better scheme there."
        )
    return text
