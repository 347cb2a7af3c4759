"""The figures of the fidelity report. Drawn under `figures.style.context`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullLocator

from owtsweep.figures import style
from owtsweep.studies.hub.fidelity.boundaries import Boundary
from owtsweep.studies.hub.fidelity.claims import BOUNDARY_TOLERANCE
from owtsweep.studies.hub.fidelity.evidence import SCHEMES
from owtsweep.studies.hub.fidelity.score import BOUNDARIES
from owtsweep.studies.hub.fidelity.statements import TABLE_CELLS
from owtsweep.studies.hub.looks import LOOKS

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BAND: dict[str, Any] = {"color": "0.5", "alpha": 0.15, "linewidth": 0.0}
MEASURES = {"x": "x", "y": "y", "vx": "v$_x$", "vy": "v$_y$"}
POSITIONS = ("x", "y")


def scatter(numbers: pd.DataFrame) -> Figure:
    """Published against reproduced numbers, with the spread of single records.

    Parameters
    ----------
    numbers
        As `compare_numbers` returns them; numbers that the run lacks are left out.
    """
    figure = style.new_figure(10.0, 4.7)
    known = numbers.dropna(subset="reproduced")
    panels = (
        ("MSE of x and y (m²)", known["measure"].isin(POSITIONS)),
        ("MSE of v$_x$ and v$_y$ (m²/s²)", ~known["measure"].isin(POSITIONS)),
    )
    for axes, (title, inside) in zip(figure.subplots(1, 2), panels, strict=True):
        _scatter_panel(axes, known[inside])
        axes.set_title(title)
    handles: list[Any] = [
        Line2D([], [], color=LOOKS[s].color, marker=LOOKS[s].marker, linestyle="none", label=s)
        for s in SCHEMES
    ]
    handles += [
        Line2D([], [], color="0.3", linewidth=1.0, label="95 % of single\nrecords"),
        Line2D([], [], color="0.3", linewidth=0.8, linestyle=":", label="equal"),
    ]
    band = Patch(label="factor of 2", **BAND)
    figure.legend(handles=[*handles, band], loc="outside right center", frameon=False)
    return figure


def _scatter_panel(axes: Axes, numbers: pd.DataFrame) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    if len(numbers):
        ends = numbers[["published", "reproduced", "record_low", "record_high"]].to_numpy()
        low, high = 0.6 * float(np.min(ends)), float(np.max(ends)) / 0.6
        line = np.array([low, high])
        axes.fill_between(line, line / 2.0, line * 2.0, **BAND)
        axes.plot(line, line, color="0.3", linewidth=0.8, linestyle=":")
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
    axes.set_aspect("equal")
    for scheme in SCHEMES:
        rows, look = numbers[numbers["scheme"] == scheme], LOOKS[scheme]
        axes.vlines(
            rows["published"], rows["record_low"], rows["record_high"], color=look.color, alpha=0.6
        )
        axes.plot(
            rows["published"], rows["reproduced"], look.marker, color=look.color, markersize=5.5,
            markeredgecolor="white", markeredgewidth=0.6,
        )  # fmt: skip
    axes.set_xlabel("published")
    axes.set_ylabel("this run, mean of the records")


def ratios(numbers: pd.DataFrame) -> Figure:
    """log2 of reproduced over published, by table, measure and scheme.

    Parameters
    ----------
    numbers
        As `compare_numbers` returns them; numbers that the run lacks are left out.
    """
    figure = style.new_figure(10.0, 4.2)
    for axes, (number, cell) in zip(
        figure.subplots(1, len(TABLE_CELLS), sharey=True), TABLE_CELLS.items(), strict=True
    ):
        axes.axhspan(-1.0, 1.0, **BAND)
        axes.axhline(0.0, color="0.3", linewidth=0.8, linestyle=":")
        for shift, scheme in zip(np.linspace(-0.3, 0.3, len(SCHEMES)), SCHEMES, strict=True):
            look = LOOKS[scheme]
            rows = numbers[(numbers["table"] == number) & (numbers["scheme"] == scheme)]
            rows = rows.dropna(subset="reproduced")
            place = np.array([list(MEASURES).index(m) for m in rows["measure"]]) + shift
            axes.vlines(
                place,
                np.log2(rows["record_low"] / rows["published"]),
                np.log2(rows["record_high"] / rows["published"]),
                color=look.color,
                alpha=0.6,
            )
            axes.plot(place, rows["log2"], look.marker, color=look.color, markersize=5.5)
        axes.set_xticks(range(len(MEASURES)), list(MEASURES.values()))
        axes.set_xlim(-0.6, len(MEASURES) - 0.4)
        axes.set_title(f"Table {number}: {cell}")
        if numbers.loc[numbers["table"] == number, "reproduced"].isna().all():
            axes.text(1.5, 0.0, "not in this run", ha="center", va="center")
    figure.axes[0].set_ylabel("log$_2$(this run / published)")
    handles: list[Any] = [
        Line2D([], [], color=LOOKS[s].color, marker=LOOKS[s].marker, linestyle="-", label=s)
        for s in SCHEMES
    ]
    handles.append(Patch(label="factor of 2", **BAND))
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def boundary_plot(boundaries: Mapping[float, Boundary], amplitudes: Sequence[float]) -> Figure:
    """The HME1/HME2 boundary over natural period, with its interval and the published two."""
    figure = style.new_figure(7.0, 4.2)
    axes = figure.subplots()
    axes.set_yscale("log")
    # room for the published boundaries, whatever the run's own amplitudes
    bottom, top = min(*amplitudes, 0.1), max(*amplitudes, 5.0)
    for period, printed in BOUNDARIES.items():
        ends = (printed / BOUNDARY_TOLERANCE, printed * BOUNDARY_TOLERANCE)
        axes.fill_between([period - 0.25, period + 0.25], *ends, **BAND)
        axes.plot(period, printed, "D", markersize=8, color="0.3", markerfacecolor="none")
    known = {p: b for p, b in boundaries.items() if np.isfinite(b.value)}
    if known:
        value = np.array([b.value for b in known.values()])
        low = np.clip([b.low for b in known.values()], bottom, top)
        high = np.clip([b.high for b in known.values()], bottom, top)
        axes.plot(list(known), value, "o-", color="black", markersize=5)
        axes.vlines(list(known), low, high, color="black", linewidth=1.5)
    for period, none in boundaries.items():
        if none.wins:
            text = f"none:\n{none.wins} better\nthroughout"
            axes.text(period, 0.92 * top, text, ha="center", va="top", fontsize=8)
    if known:
        axes.text(0.02, 0.97, "HME1 better", transform=axes.transAxes, va="top")
        axes.text(0.98, 0.03, "HME2 better", transform=axes.transAxes, ha="right")
    shown = [*boundaries, *BOUNDARIES]
    axes.set_xlim(min(shown) - 0.5, max(shown) + 0.5)
    axes.set_ylim(bottom, top)
    axes.xaxis.set_major_locator(MultipleLocator(1.0))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlabel("natural period (s)")
    axes.set_ylabel("motion amplitude (m)")
    hollow: dict[str, Any] = {"color": "0.3", "markerfacecolor": "none", "linestyle": "none"}
    handles: list[Any] = [
        Line2D([], [], color="black", marker="o", label="this run, 95 % interval"),
        Line2D([], [], marker="D", label="published", **hollow),
        Patch(label="factor of 2", **BAND),
    ]
    axes.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=3,
        frameon=False,
    )
    return figure
