"""Published against reproduced numbers as figures. Drawn under `figures.style.context`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from owtsweep.figures import style
from owtsweep.figures.palette import style_of

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: The look of an area of agreement.
BAND: dict[str, Any] = {"color": "0.5", "alpha": 0.15, "linewidth": 0.0}


def scatter(
    numbers: pd.DataFrame, schemes: Sequence[str], panels: Mapping[str, Sequence[str]]
) -> Figure:
    """Published against reproduced numbers, with the spread of single records.

    Parameters
    ----------
    numbers
        Columns scheme, measure, published, and those of `verdicts.numbers.compare_number`; numbers
        that the run lacks are left out.
    schemes
        The schemes to draw, in the order of the legend.
    panels
        Title of a panel -> its measures.
    """
    figure = style.new_figure(10.0, 4.7)
    present = numbers.dropna(subset="reproduced")
    for axes, (title, measures) in zip(figure.subplots(1, 2), panels.items(), strict=True):
        _scatter_panel(axes, present[present["measure"].isin(measures)], schemes)
        axes.set_title(title)
    handles = [
        *_handles(schemes, linestyle="none"),
        Line2D([], [], color="0.3", linewidth=1.0, label="95 % of single\nrecords"),
        Line2D([], [], color="0.3", linewidth=0.8, linestyle=":", label="equal"),
        Patch(label="factor of 2", **BAND),
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def _handles(schemes: Sequence[str], **look: Any) -> list[Any]:
    handles = []
    for name in schemes:
        scheme = style_of(name, schemes)
        handles.append(Line2D([], [], color=scheme.color, marker=scheme.marker, label=name, **look))
    return handles


def _scatter_panel(axes: Axes, numbers: pd.DataFrame, schemes: Sequence[str]) -> None:
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
    for scheme in schemes:
        rows, look = numbers[numbers["scheme"] == scheme], style_of(scheme, schemes)
        axes.vlines(
            rows["published"], rows["record_low"], rows["record_high"], color=look.color, alpha=0.6
        )
        axes.plot(
            rows["published"], rows["reproduced"], look.marker, color=look.color, markersize=5.5,
            markeredgecolor="white", markeredgewidth=0.6,
        )  # fmt: skip
    axes.set_xlabel("published")
    axes.set_ylabel("this run, mean of the records")


def ratios(
    numbers: pd.DataFrame,
    schemes: Sequence[str],
    measures: Mapping[str, str],
    tables: Mapping[int, object],
) -> Figure:
    """log2 of reproduced over published, by table, measure and scheme.

    Parameters
    ----------
    numbers
        As for `scatter`, and the column table.
    schemes
        The schemes to draw, in the order of the legend.
    measures
        Measure -> its label.
    tables
        Number of a table -> its conditions.
    """
    figure = style.new_figure(10.0, 4.2)
    for axes, (number, cell) in zip(
        figure.subplots(1, len(tables), sharey=True), tables.items(), strict=True
    ):
        of_table = numbers[numbers["table"] == number]
        _ratio_panel(axes, of_table, schemes, list(measures))
        axes.set_xticks(range(len(measures)), list(measures.values()))
        axes.set_xlim(-0.6, len(measures) - 0.4)
        axes.set_title(f"Table {number}: {cell}")
        if of_table["reproduced"].isna().all():
            middle = 0.5 * (len(measures) - 1)
            axes.text(middle, 0.0, "not in this run", ha="center", va="center")
    figure.axes[0].set_ylabel("log$_2$(this run / published)")
    handles = [*_handles(schemes, linestyle="-"), Patch(label="factor of 2", **BAND)]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def _ratio_panel(
    axes: Axes, numbers: pd.DataFrame, schemes: Sequence[str], measures: list[str]
) -> None:
    axes.axhspan(-1.0, 1.0, **BAND)
    axes.axhline(0.0, color="0.3", linewidth=0.8, linestyle=":")
    for shift, scheme in zip(np.linspace(-0.3, 0.3, len(schemes)), schemes, strict=True):
        color, marker = style_of(scheme, schemes).color, style_of(scheme, schemes).marker
        rows = numbers[numbers["scheme"] == scheme].dropna(subset="reproduced")
        place = np.array([measures.index(m) for m in rows["measure"]]) + shift
        low, high = (
            np.log2(rows[end] / rows["published"]) for end in ("record_low", "record_high")
        )
        axes.vlines(place, low, high, color=color, alpha=0.6)
        axes.plot(place, rows["log2"], marker, color=color, markersize=5.5)
