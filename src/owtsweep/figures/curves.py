"""Draw measures against one condition: a curve for each scheme, with a band of 95 % intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullLocator

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import SchemeStyle, style_of
from owtsweep.results.conditions import Condition, Value, order_values, show_value

#: Every value of the condition has a tick, unless two ticks would be closer than this fraction of a
#: logarithmic axis.
CLOSEST_TICKS = 0.045
#: A logarithmic axis cannot show zero, so the lower end of an interval is at least this fraction of
#: its mean.
LOWEST = 0.1


def choose(
    summary: pd.DataFrame, schemes: Sequence[str], window: str, fixed: Mapping[Condition, Value]
) -> pd.DataFrame:
    """Return the rows of a run's summary with given schemes, window and values of conditions.

    A condition that is not in `fixed` may have any value. Raise `InputError` if there are no such
    rows.
    """
    shown = in_window = summary[summary["window"] == window]
    for condition, value in fixed.items():
        column = shown[condition.name]
        at = column == value if isinstance(value, str) else np.isclose(column, value, rtol=1e-9)
        shown = shown[at]
    shown = shown[shown["scheme"].isin(list(schemes))]
    if shown.empty:
        names = " and ".join(condition.name for condition in fixed)
        where = ", ".join(condition.show(value) for condition, value in fixed.items())
        present = "; ".join(
            ", ".join(map(show_value, order_values(in_window[condition.name])))
            for condition in fixed
        )
        raise InputError(
            f"{names}: no result at {where} in window {window!r}; this run has {present or 'none'}"
        )
    return shown


def draw(
    shown: pd.DataFrame,
    schemes: Sequence[str],
    along: Condition,
    panels: Mapping[str, str],
    *,
    title: str,
    coinciding: Sequence[Sequence[str]] = (),
    notes: Sequence[str] = (),
    thin: Sequence[str] = (),
) -> Figure:
    """Draw measures of several schemes against a condition, one panel per measure, side by side.

    shown: rows of a run's table summary.csv. Every condition except `along` has one value.
    schemes: names of the schemes to draw, in the order of the legend.
    along: the condition on the horizontal axis.
    panels: Name of a measure -> label of the vertical axis of its panel, which is logarithmic.
    coinciding: Groups of names of schemes with equal results, which the footnote lists.
    thin: Further schemes, drawn behind the others as thin lines without intervals. The vertical
        axis shows the range of the others.
    """
    levels = order_values(shown[along.name], shown[along.name].unique())
    figure = style.new_figure(5.0 * len(panels), 5.0)
    grid = figure.subplots(1, len(panels), squeeze=False)[0]
    for axes, (measure, label) in zip(grid, panels.items(), strict=True):
        _draw_curves(axes, shown[shown["measure"] == measure], schemes, along, levels)
        scale_axes(axes, along, levels)
        limits = axes.get_ylim()
        for name in thin:
            rows = shown[(shown["scheme"] == name) & (shown["measure"] == measure)]
            place = _place(rows[along.name], levels)
            order = np.argsort(place, kind="stable")
            line = thin_line(style_of(name, thin))
            axes.plot(place[order], rows["mean"].iloc[order], **line)
        axes.set_ylim(limits)
        axes.set_ylabel(label)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    handles = _make_legend(shown, schemes)
    handles += [
        Line2D([], [], label=style.label_of(name), **thin_line(style_of(name, thin)))
        for name in thin
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    style.footnote(figure, " ".join([*_explain(shown, coinciding), *notes]))
    return figure


def _place(column: pd.Series[float], levels: Sequence[Value]) -> Array:
    """Return places on the horizontal axis: a number itself, the index of a text in `levels`."""
    if isinstance(levels[0], str):
        return column.map(levels.index).to_numpy()
    return column.to_numpy()


def _draw_curves(
    axes: Axes,
    rows: pd.DataFrame,
    schemes: Sequence[str],
    along: Condition,
    levels: Sequence[Value],
) -> None:
    import seaborn as sns  # takes a second to import

    rows = rows[rows["scheme"].isin(list(schemes))].astype({"scheme": object})
    place, mean = _place(rows[along.name], levels), rows["mean"]
    low = rows["ci_low"].clip(lower=LOWEST * mean)
    # The intervals are those of the table. seaborn makes its own from samples, so each point is
    # given as three: the median of them is the mean, and all of them span the interval.
    ends = (mean, low.fillna(mean), rows["ci_high"].fillna(mean))
    samples = pd.concat(
        [pd.DataFrame({"scheme": rows["scheme"], "place": place, "error": end}) for end in ends],
        ignore_index=True,
    )
    looks = {name: style_of(name, schemes) for name in schemes}
    lines = {name: "" if look.line == "-" else look.line[1] for name, look in looks.items()}
    sns.lineplot(
        samples, x="place", y="error", hue="scheme", style="scheme", ax=axes, legend=False,
        hue_order=schemes, style_order=schemes, dashes=lines,
        palette={name: look.color for name, look in looks.items()},
        markers={name: look.marker for name, look in looks.items()},
        estimator="median", errorbar=("pi", 100), err_kws={"linewidth": 0.0},
        markersize=4.5, markeredgewidth=0.0,
    )  # fmt: skip
    for name, look in looks.items():
        mine = rows["scheme"] == name
        axes.vlines(place[mine], low[mine], rows["ci_high"][mine], color=look.color, linewidth=1.0)


def thin_line(look: SchemeStyle) -> style.Look:
    return {"color": look.color, "linestyle": look.line, "linewidth": 1.1, "zorder": 1.5}


def scale_axes(axes: Axes, along: Condition, levels: Sequence[Value]) -> None:
    """Set scales, ticks and label: values of a condition to the right, a logarithmic axis upwards.

    `levels` are the distinct values of the condition in order.
    """
    axes.set_yscale("log")
    axes.set_xlabel(along.title)
    axes.tick_params(axis="x", labelsize=8)
    if isinstance(levels[0], str):
        axes.set_xticks(range(len(levels)), [show_value(value) for value in levels])
        return
    if along.scale == "linear":
        return
    axes.set_xscale("log")
    numbers = [float(value) for value in levels]
    ticks = np.log(numbers)
    span = ticks[-1] - ticks[0]
    if span == 0.0 or np.min(np.diff(ticks)) >= CLOSEST_TICKS * span:
        axes.set_xticks(numbers)
    else:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter("{x:g}")
    if span == 0.0:
        axes.set_xlim(numbers[0] / 2.0, numbers[0] * 2.0)


def _make_legend(shown: pd.DataFrame, schemes: Sequence[str]) -> list[Artist]:
    handles: list[Artist] = []
    for name in schemes:
        look = style_of(name, schemes)
        line: style.Look = {"linestyle": look.line, "marker": look.marker}
        line["label"] = style.label_of(name)
        handles.append(Line2D([], [], color=look.color, **line))
    if shown["ci_low"].notna().any():
        handles.append(Patch(facecolor="0.6", alpha=0.5, label="95 % interval\nof the mean"))
    return handles


def _explain(shown: pd.DataFrame, coinciding: Sequence[Sequence[str]]) -> list[str]:
    sentences = [f"{' and '.join(group)} give the same numbers." for group in coinciding]
    if shown["ci_low"].notna().any():
        sentences.append(
            "Intervals are of each mean by itself. All schemes saw the same records, so overlapping"
            " intervals do not mean that two schemes cannot be told apart: see the map."
        )
    if (shown["ci_low"] < LOWEST * shown["mean"]).any():
        sentences.append(f"Intervals are cut at {LOWEST:g} of the mean.")
    return sentences
