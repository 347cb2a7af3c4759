"""Figures 15-17 of Ren et al. (2019): MSE over amplitude at one natural period."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.studies.hub import published

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: The panels: measure, label of its axis, the published measures that it sums.
PANELS = (
    ("position", "position MSE, x + y (m²)", ("x", "y")),
    ("velocity", "velocity MSE, vx + vy (m²/s²)", ("vx", "vy")),
)
#: Every amplitude has its tick unless two would be closer than this part of the axis.
CLOSEST_TICKS = 0.045
#: A logarithmic axis has no place for zero: intervals end at this part of their mean at the latest.
LOWEST = 0.1


@dataclass(frozen=True)
class _Print:
    """The published points of one natural period within a range of amplitudes."""

    points: pd.DataFrame
    tables: tuple[int, ...]
    notes: tuple[str, ...]


def draw(
    summary: pd.DataFrame,
    natural_period: float,
    schemes: Sequence[str],
    *,
    window: str,
    tuning: str,
    coinciding: Sequence[Sequence[str]] = (),
) -> Figure:
    """Draw position and velocity MSE of all schemes over the amplitude, log-log.

    Parameters
    ----------
    summary
        Columns of summary.csv.
    natural_period
        In s; one of those in `summary`.
    schemes
        Schemes to draw, in the order of the legend.
    window, tuning
        Named in the title; `window` selects the rows.
    coinciding
        Groups of schemes with the same numbers (`aggregate.coinciding`), for the footnote.

    Raises
    ------
    InputError
        If `summary` has nothing to draw at that period in that window.
    """
    in_window = summary[summary["window"] == window]
    shown = in_window[np.isclose(in_window["natural_period"], natural_period, rtol=1e-9)]
    shown = shown[shown["scheme"].isin(list(schemes))]
    if shown.empty:
        known = ", ".join(f"{period:g}" for period in sorted(set(in_window["natural_period"])))
        raise InputError(
            f"natural_period: no result at {natural_period:g} s in window {window!r};"
            f" this run has {known or 'none'}"
        )
    amplitudes = sorted(set(shown["amplitude"]))
    printed = _printed(natural_period, amplitudes, schemes)

    with style.context():
        figure = style.new_figure(10.0, 5.0)
        for axes, (measure, label, parts) in zip(figure.subplots(1, 2), PANELS, strict=True):
            for name in schemes:
                rows = shown[(shown["scheme"] == name) & (shown["measure"] == measure)]
                _line(axes, rows.sort_values("amplitude"), name, schemes)
                _published_points(axes, printed.points, name, parts, schemes)
            _scales(axes, amplitudes)
            axes.set_ylabel(label)
        figure.suptitle(
            f"Mean squared error over amplitude, natural period {natural_period:g} s\n"
            f"{style.describe_window(window)}, tuning: {tuning}",
            x=0.01,
            ha="left",
            fontsize=11,
        )
        figure.legend(
            handles=_legend(shown, schemes, printed),
            loc="outside right center",
            frameon=False,
        )
        style.footnote(figure, " ".join([*_explanations(shown, coinciding), *printed.notes]))
    return figure


def _printed(natural_period: float, amplitudes: Sequence[float], schemes: Sequence[str]) -> _Print:
    table = published.mse_tables()
    inside = table["amplitude"].between(min(amplitudes), max(amplitudes))
    here = np.isclose(table["natural_period"], natural_period) & inside
    points = table[here & table["scheme"].isin(list(schemes))]
    notes = [
        f"Table {row['table']}, {row['scheme']}: {row['note']}."
        for row in points[points["note"] != ""].to_dict("records")
    ]
    return _Print(points, tuple(sorted(set(points["table"]))), tuple(notes))


def _line(axes: Axes, rows: pd.DataFrame, name: str, schemes: Sequence[str]) -> None:
    look = style_of(name, schemes)
    amplitude, mean = rows["amplitude"].to_numpy(), rows["mean"].to_numpy()
    axes.plot(
        amplitude, mean, color=look.color, linestyle=look.line, marker=look.marker, markersize=4.5
    )
    low = np.maximum(rows["ci_low"].to_numpy(), LOWEST * mean)
    high = rows["ci_high"].to_numpy()
    axes.fill_between(amplitude, low, high, color=look.color, alpha=0.2, linewidth=0.0)
    axes.vlines(amplitude, low, high, color=look.color, linewidth=1.0)


def _published_points(
    axes: Axes, points: pd.DataFrame, name: str, parts: Sequence[str], schemes: Sequence[str]
) -> None:
    look = style_of(name, schemes)
    chosen = points[(points["scheme"] == name) & points["measure"].isin(list(parts))]
    total = chosen.groupby("amplitude")["published"].sum()
    axes.plot(
        total.index,
        total.to_numpy(),
        color=look.color,
        marker=look.marker,
        markerfacecolor="none",
        markersize=10,
        markeredgewidth=1.6,
        linestyle="none",
    )


def _scales(axes: Axes, amplitudes: Sequence[float]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("motion amplitude (m)")
    ticks = np.log(np.asarray(amplitudes))
    span = ticks[-1] - ticks[0]
    if span == 0.0 or np.min(np.diff(ticks)) >= CLOSEST_TICKS * span:
        axes.set_xticks(amplitudes)
    else:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.tick_params(axis="x", labelsize=8)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    if span == 0.0:
        axes.set_xlim(amplitudes[0] / 2.0, amplitudes[0] * 2.0)


def _legend(shown: pd.DataFrame, schemes: Sequence[str], printed: _Print) -> list[Any]:
    handles: list[Any] = []
    for name in schemes:
        look = style_of(name, schemes)
        handles.append(
            Line2D([], [], color=look.color, linestyle=look.line, marker=look.marker, label=name)
        )
    if shown["ci_low"].notna().any():
        handles.append(Patch(facecolor="0.6", alpha=0.5, label="95 % interval\nof the mean"))
    if printed.tables:
        numbers = ", ".join(map(str, printed.tables))
        noun = "Tables" if len(printed.tables) > 1 else "Table"
        handles.append(
            Line2D(
                [],
                [],
                color="0.3",
                marker="o",
                markerfacecolor="none",
                markersize=10,
                markeredgewidth=1.6,
                linestyle="none",
                label=f"hollow: published\n({noun} {numbers})",
            )
        )
    return handles


def _explanations(shown: pd.DataFrame, coinciding: Sequence[Sequence[str]]) -> list[str]:
    sentences = [f"{' and '.join(group)} give the same numbers." for group in coinciding]
    if shown["ci_low"].notna().any():
        sentences.append(
            "Intervals are of each mean by itself. All schemes saw the same records, so overlapping"
            " intervals do not mean that two schemes cannot be told apart: see the map."
        )
    if (shown["ci_low"] < LOWEST * shown["mean"]).any():
        sentences.append(f"Intervals are cut at {LOWEST:g} of the mean.")
    return sentences
