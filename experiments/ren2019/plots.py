"""Draw the run beside Ren et al. (2019): numbers, ratios, and the boundary of HME1 and HME2.

Call the functions in `figures.style.context`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullLocator

from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS, tolerated
from experiments.ren2019.published import BOUNDARIES
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.verdicts.score_table import Boundary

#: Measure of the paper's tables -> its label.
MEASURES = {"x": "x", "y": "y", "vx": "v$_x$", "vy": "v$_y$"}
#: Title of a panel -> its measures.
PANELS = {"MSE of x and y (m²)": ("x", "y"), "MSE of v$_x$ and v$_y$ (m²/s²)": ("vx", "vy")}
#: The look of an area of agreement.
BAND: dict[str, Any] = {"color": "0.5", "alpha": 0.15, "linewidth": 0.0}


def scatter(numbers: pd.DataFrame) -> Figure:
    """Draw published numbers (horizontal) against the run's means (vertical), in two panels.

    A mark's vertical line spans the central 95 % of the run's single records. `numbers` are those
    of `numbers.compare_numbers`; rows whose `reproduced` is NaN are left out.
    """
    figure = style.new_figure(10.0, 4.7)
    present = numbers.dropna(subset="reproduced")
    for axes, (title, measures) in zip(figure.subplots(1, 2), PANELS.items(), strict=True):
        _scatter_panel(axes, present[present["measure"].isin(measures)])
        axes.set(xlabel=f"{title}, published", ylabel=f"{title},\nthis run, mean of the records")
    handles = [
        *_handles("none"),
        Line2D([], [], color="0.3", linewidth=1.0, label="95 % of single\nrecords"),
        Line2D([], [], color="0.3", linewidth=0.8, linestyle=":", label="equal"),
        Patch(label="factor of 2", **BAND),
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def _handles(line: Any) -> list[Any]:
    looks = [(name, style_of(name, SCHEMES)) for name in SCHEMES]
    return [
        Line2D([], [], color=look.color, marker=look.marker, linestyle=line, label=name)
        for name, look in looks
    ]


def _scatter_panel(axes: Axes, numbers: pd.DataFrame) -> None:
    axes.set(xscale="log", yscale="log", aspect="equal")
    if len(numbers):
        ends = numbers[["published", "reproduced", "record_low", "record_high"]].to_numpy()
        ends = ends[ends > 0.0]  # a perfect scheme has the value 0, which has no place on the axis
        low, high = 0.6 * float(np.min(ends)), float(np.max(ends)) / 0.6
        line = np.array([low, high])
        axes.fill_between(line, line / 2.0, line * 2.0, **BAND)
        axes.plot(line, line, color="0.3", linewidth=0.8, linestyle=":")
        axes.set(xlim=(low, high), ylim=(low, high))
    for scheme in SCHEMES:
        rows, look = numbers[numbers["scheme"] == scheme], style_of(scheme, SCHEMES)
        axes.vlines(
            rows["published"], rows["record_low"], rows["record_high"], color=look.color, alpha=0.6
        )
        axes.plot(
            rows["published"], rows["reproduced"], look.marker, color=look.color, markersize=5.5,
            markeredgecolor="white", markeredgewidth=0.6,
        )  # fmt: skip


def ratios(numbers: pd.DataFrame) -> Figure:
    """Draw log2(reproduced / published) of every measure and scheme, one panel per published table.

    A mark's vertical line spans the central 95 % of the run's single records. `numbers` are those
    of `numbers.compare_numbers`.
    """
    figure = style.new_figure(10.0, 4.2)
    panels = figure.subplots(1, len(TABLE_CELLS), sharey=True)
    for axes, (number, cell) in zip(panels, TABLE_CELLS.items(), strict=True):
        of_table = numbers[numbers["table"] == number]
        _ratio_panel(axes, of_table)
        axes.set_xticks(range(len(MEASURES)), list(MEASURES.values()))
        axes.set(xlim=(-0.6, len(MEASURES) - 0.4), title=f"Table {number}: {cell}")
        if of_table["reproduced"].isna().all():
            middle = 0.5 * (len(MEASURES) - 1)
            axes.text(middle, 0.0, "not in this run", ha="center", va="center")
    figure.axes[0].set_ylabel("log$_2$(this run / published)")
    handles = [*_handles("-"), Patch(label="factor of 2", **BAND)]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def _ratio_panel(axes: Axes, numbers: pd.DataFrame) -> None:
    axes.axhspan(-1.0, 1.0, **BAND)
    axes.axhline(0.0, color="0.3", linewidth=0.8, linestyle=":")
    for shift, scheme in zip(np.linspace(-0.3, 0.3, len(SCHEMES)), SCHEMES, strict=True):
        look = style_of(scheme, SCHEMES)
        rows = numbers[numbers["scheme"] == scheme].dropna(subset="reproduced")
        place = np.array([list(MEASURES).index(m) for m in rows["measure"]]) + shift
        with np.errstate(divide="ignore", invalid="ignore"):  # a value that is not positive
            low = np.log2(rows["record_low"] / rows["published"])
            high = np.log2(rows["record_high"] / rows["published"])
        there = np.isfinite(low) & np.isfinite(high)
        axes.vlines(place[there], low[there], high[there], color=look.color, alpha=0.6)
        axes.plot(place, rows["log2"], look.marker, color=look.color, markersize=5.5)


def draw_boundaries(boundaries: Mapping[float, Boundary], amplitudes: Sequence[float]) -> Figure:
    """Draw the amplitude (m) at which HME1 and HME2 are equally good against natural period (s).

    This amplitude is the boundary. The figure shows the boundaries of a run and of Ren et al.
    (2019).

    Parameters
    ----------
    boundaries
        Natural period (s) -> the run's boundary, drawn with its 95 % interval. If there is no
        boundary, a text says which scheme is better throughout.
    amplitudes
        The run's amplitudes in m, which set the limits of the vertical axis.
    """
    figure = style.new_figure(7.0, 4.2)
    axes = figure.subplots()
    axes.set_yscale("log")
    diamond: Any = {"marker": "D", "color": "0.3", "markerfacecolor": "none", "linestyle": "none"}
    # room for the published boundaries, whatever the run's amplitudes are
    bottom, top = min(*amplitudes, 0.1), max(*amplitudes, 5.0)
    for period, printed in BOUNDARIES.items():
        axes.fill_between([period - 0.25, period + 0.25], *tolerated(period), **BAND)
        axes.plot(period, printed, markersize=8, **diamond)
    for period, none in boundaries.items():
        if none.wins:
            text = f"none:\n{none.wins} better\nthroughout"
            axes.text(period, 0.92 * top, text, ha="center", va="top", fontsize=8)
    finite = {p: b for p, b in boundaries.items() if np.isfinite(b.value)}
    if finite:
        value = np.array([b.value for b in finite.values()])
        low = np.clip([b.low for b in finite.values()], bottom, top)
        high = np.clip([b.high for b in finite.values()], bottom, top)
        axes.plot(list(finite), value, "o-", color="black", markersize=5)
        axes.vlines(list(finite), low, high, color="black", linewidth=1.5)
        axes.text(0.02, 0.97, "HME1 better", transform=axes.transAxes, va="top")
        axes.text(0.98, 0.03, "HME2 better", transform=axes.transAxes, ha="right")
    shown = [*boundaries, *BOUNDARIES]
    axes.set(xlim=(min(shown) - 0.5, max(shown) + 0.5), ylim=(bottom, top))
    axes.set(xlabel="natural period (s)", ylabel="motion amplitude (m)")
    axes.xaxis.set_major_locator(MultipleLocator(1.0))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    handles = [
        Line2D([], [], color="black", marker="o", label="this run, 95 % interval"),
        Line2D([], [], label="published", **diamond),
        Patch(label="factor of 2", **BAND),
    ]
    axes.legend(
        handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False
    )
    return figure
