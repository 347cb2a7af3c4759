"""Draw the figure of the fidelity report on the boundary between HME1 and HME2.

The boundary is the amplitude at which both schemes are equally good. Drawing must happen inside the
context `figures.style.context`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullLocator

from owtsweep.figures import style
from owtsweep.studies.hub.fidelity.boundaries import PUBLISHED, tolerated
from owtsweep.studies.hub.fidelity.evidence import Boundary
from owtsweep.verdicts.plots import BAND

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    for period, printed in PUBLISHED.items():
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
    shown = [*boundaries, *PUBLISHED]
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
