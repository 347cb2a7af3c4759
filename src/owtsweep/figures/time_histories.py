"""Draw quantities of a record over time, in two or three panels below each other.

Usually the panels show x, y, and the errors of some schemes. A study defines what each panel shows
(`Panel`). This module defines layout, legend and style.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.lines import Line, clip, make_line
from owtsweep.figures.palette import style_of
from owtsweep.figures.style import Look

#: Lengths in inches, and the relative heights of the panels.
WIDTH, HEIGHT = 10.0, {2: 5.4, 3: 7.2}
RATIOS = (1.0, 1.0, 0.8)
UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "bias": "m/s²"}
NAMES = {"bias": "Accelerometer bias"}

#: The place in the order of drawing of a curve above all other curves, but below the fixes.
ON_TOP = 2.8

#: Times (n,) in s, and the errors at them, (n, axes).
Errors = tuple[Array, Array]


@dataclass(frozen=True)
class Curve:
    """A line in a panel with matplotlib's properties; "label" puts it into the legend."""

    line: Line
    look: Look

    def draw(self, axes: Axes) -> None:
        """Draw the line; only its first piece gets the label, so the legend has one entry."""
        look = dict(self.look)
        for time, values in self.line:
            axes.plot(time, values, **look)
            look.pop("label", None)


@dataclass(frozen=True)
class Level:
    """A horizontal line in a panel; dotted if it is a bound, else full."""

    value: float
    bound: bool = False

    def draw(self, axes: Axes) -> None:
        width, dashes = (1.0, ":") if self.bound else (0.8, "-")
        axes.axhline(self.value, color="0.3", linewidth=width, linestyle=dashes)


@dataclass(frozen=True)
class Band:
    """A filled area in a panel between two time series (n,); `time` is in s."""

    time: Array
    low: Array
    high: Array
    color: str

    def draw(self, axes: Axes) -> None:
        axes.fill_between(self.time, self.low, self.high, color=self.color, alpha=0.15, linewidth=0)


@dataclass(frozen=True)
class Panel:
    """The contents of one panel of a figure.

    marks: the lines and areas to draw; later ones are drawn over earlier ones.
    view: First and last time on the horizontal axis, in s.
    limits: Limits of the vertical axis; matplotlib chooses one that is None.
    note, note_color: Text above the panel, or "", and its colour.
    """

    label: str
    marks: Sequence[Curve | Level | Band]
    view: tuple[float, float]
    limits: tuple[float | None, float | None] = (None, None)
    note: str = ""
    note_color: str = "black"


def draw(
    panels: Sequence[Panel],
    *,
    title: str,
    footnote: str,
    time_label: str = "time (s)",
    shared: bool = False,
) -> Figure:
    """Draw two or three panels over time below each other; the legend is that of the top panel.

    If `shared`, all panels have one horizontal axis, and only the lowest has tick labels on it.
    """
    count = len(panels)
    figure = style.new_figure(WIDTH, HEIGHT[count])
    grid = figure.subplots(count, 1, height_ratios=RATIOS[:count], sharex=shared)
    for axes, panel in zip(grid, panels, strict=True):
        for mark in panel.marks:
            mark.draw(axes)
        axes.set(xlim=panel.view, ylim=panel.limits, ylabel=panel.label)
        axes.set_title(panel.note, loc="left", fontsize=9, color=panel.note_color)
    grid[-1].set_xlabel(time_label)
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    style.footnote(figure, footnote)
    return figure


def describe(quantity: str) -> str:
    """Return a quantity for the beginning of a title, e.g. "Accelerometer bias" for "bias"."""
    return NAMES.get(quantity, quantity.capitalize())


def show_truth(line: Line, label: str = "truth") -> Curve:
    """Make the curve of the true values of a quantity, in black."""
    return Curve(line, {"color": "black", "linewidth": 1.4, "label": label})


def show_measurement(line: Line) -> Curve:
    """Make the curve of an IMU's measurements, in grey, with the legend entry "IMU"."""
    return Curve(line, {"color": "0.75", "linewidth": 0.6, "label": "IMU"})


def show_fixes(time: Array, values: Array, *, label: str, size: float) -> Curve:
    """Make a curve of marks "+", one for each fix (n,) along an axis, at its arrival in s.

    `size` is in points (1/72 inch).
    """
    look = {"color": "0.45", "marker": "+", "linestyle": "none", "markersize": size}
    return Curve([(time, values)], {**look, "label": label, "zorder": 3})


def show_scheme(name: str, names: Sequence[str], line: Line, look: Look) -> Curve:
    """Make a curve in the colour and line style of the scheme `name`, one of the study's `names`.

    `look` holds further properties of the line for matplotlib, e.g. `linewidth`.
    """
    scheme = style_of(name, names)
    return Curve(line, {"color": scheme.color, "linestyle": scheme.line, **look})


def show_estimate(name: str, names: Sequence[str], line: Line, *, on_top: bool = False) -> Curve:
    """Make the curve of the estimate of the scheme `name`, one of the study's `names`.

    It is drawn over the true values; `on_top` over the other schemes' too.
    """
    zorder = ON_TOP if on_top else 2.5
    look: Look = {"linewidth": 1.2, "label": style.label_of(name), "zorder": zorder}
    return show_scheme(name, names, line, look)


def show_errors(
    errors: Mapping[str, Errors],
    names: Sequence[str],
    quantity: str,
    view: tuple[float, float],
    *,
    bound: float | None = None,
    note: str = "",
) -> Panel:
    """Make a panel of the schemes' errors in x.

    errors: Scheme -> times in s, shape (n,), and errors of x and y, shape (n, 2).
    names: All schemes of the study; a scheme's style may depend on its place among them.
    quantity: the quantity to which the errors belong, e.g. "position"; a key of `UNITS`.
    view: First and last time on the horizontal axis, in s.
    bound: a bound on the absolute error, drawn as two dotted lines, above and below zero.
    """
    marks: list[Curve | Level] = [
        show_estimate(name, names, make_line(*clip(time, error[:, 0], view)))
        for name, (time, error) in errors.items()
    ]
    if bound is not None:
        marks += [Level(-bound, bound=True), Level(bound, bound=True)]
    return Panel(f"error of x ({UNITS[quantity]})", [*marks, Level(0.0)], view, note=note)


def show_accumulated(
    errors: Mapping[str, Errors], names: Sequence[str], quantity: str, end: float
) -> Panel:
    """Make a panel of the schemes' absolute errors, integrated over time and summed over x and y.

    Arguments are as in `show_errors`. The times cover the whole record in equal steps from 0 to
    `end`, s.
    """
    marks, ends = [], []
    for name, (time, error) in errors.items():
        total = float(time[1]) * np.cumsum(np.sum(np.abs(error), axis=1))
        marks.append(show_estimate(name, names, make_line(time, total)))
        ends.append(f"{name} {total[-1]:.3g}")
    unit = {"m": "m s", "m/s": "m", "m/s²": "m/s"}[UNITS[quantity]]
    return Panel(
        label=f"accumulated |error|,\nx + y ({unit})",
        marks=marks,
        view=(0.0, end),
        limits=(0.0, None),
        note=f"over the whole record; at its end: {', '.join(ends)} {unit}",
    )
