"""Draw quantities of a record over time, in two or three panels below each other.

Usually the panels show x, y, and the errors of some schemes. A study defines what each panel shows
(`Panel`). This module defines layout, legend and looks.
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
    """A line in a panel.

    Attributes
    ----------
    line
        Times in s and values of each part of the line between two gaps.
    look
        Matplotlib's properties of the line. With the property "label", the line is in the legend.
    """

    line: Line
    look: Look

    def draw(self, axes: Axes) -> None:
        """Draw the line into `axes`.

        The line may have gaps. Only its first part gets the label, so the legend has one entry.
        """
        look = dict(self.look)
        for time, values in self.line:
            axes.plot(time, values, **look)
            look.pop("label", None)


@dataclass(frozen=True)
class Level:
    """A horizontal line in a panel, at the height `value`; dotted if `bound` is true, else full."""

    value: float
    bound: bool = False

    def draw(self, axes: Axes) -> None:
        """Draw the horizontal line over the whole width of `axes`."""
        width, dashes = (1.0, ":") if self.bound else (0.8, "-")
        axes.axhline(self.value, color="0.3", linewidth=width, linestyle=dashes)


@dataclass(frozen=True)
class Band:
    """A filled area in a panel between two time series, `low` and `high`.

    `time`, in s, `low` and `high` have the shape (n,). `color` is a colour of matplotlib.
    """

    time: Array
    low: Array
    high: Array
    color: str

    def draw(self, axes: Axes) -> None:
        """Fill the area between the series `low` and `high` in `axes`."""
        axes.fill_between(self.time, self.low, self.high, color=self.color, alpha=0.15, linewidth=0)


@dataclass(frozen=True)
class Panel:
    """The contents of one panel of a figure.

    Attributes
    ----------
    label
        Label of the vertical axis.
    marks
        The lines and areas to draw; later ones are drawn over earlier ones.
    view
        First and last time on the horizontal axis, in s.
    limits
        Lower and upper limit of the vertical axis. None in place of a limit lets matplotlib choose
        it from the values.
    note
        Text above the panel; "" means no text.
    note_color
        Colour of `note`.
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

    Parameters
    ----------
    panels
        The contents of the panels, from top to bottom.
    title, footnote
        Texts above and below all panels.
    time_label
        Label of the horizontal axis of the lowest panel.
    shared
        Whether all panels share one horizontal axis. If so, only the lowest panel has tick labels
        on it.
    """
    count = len(panels)
    figure = style.new_figure(WIDTH, HEIGHT[count])
    grid = figure.subplots(count, 1, height_ratios=RATIOS[:count], sharex=shared)
    for axes, panel in zip(grid, panels, strict=True):
        _draw_panel(axes, panel)
    grid[-1].set_xlabel(time_label)
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    style.footnote(figure, footnote)
    return figure


def _draw_panel(axes: Axes, panel: Panel) -> None:
    for mark in panel.marks:
        mark.draw(axes)
    axes.set_xlim(*panel.view)
    if panel.limits != (None, None):
        axes.set_ylim(*panel.limits)
    axes.set_ylabel(panel.label)
    if panel.note:
        axes.set_title(panel.note, loc="left", fontsize=9, color=panel.note_color)


def describe(quantity: str) -> str:
    """Return the name of a quantity for the beginning of a title, e.g. "Position" for "position".

    The name of "bias" is "Accelerometer bias".
    """
    return NAMES.get(quantity, quantity.capitalize())


def show_truth(line: Line, label: str = "truth") -> Curve:
    """Make the curve of the true values of a quantity, in black.

    `line` holds times in s and values of each part of the line between two gaps. `label` is the
    legend entry.
    """
    return Curve(line, {"color": "black", "linewidth": 1.4, "label": label})


def show_measurement(line: Line) -> Curve:
    """Make the curve of an IMU's measurements, in grey, with the legend entry "IMU".

    `line` holds times in s and values of each part of the line between two gaps.
    """
    return Curve(line, {"color": "0.75", "linewidth": 0.6, "label": "IMU"})


def show_fixes(time: Array, values: Array, *, label: str, size: float) -> Curve:
    """Make a curve of separate marks "+", one for each position fix of a slow sensor, e.g. GNSS.

    Parameters
    ----------
    time, values
        Times in s at which the fixes arrived, and the fixes along one axis; shape (n,) each.
    label
        The legend entry.
    size
        Size of a mark in points (1/72 inch).
    """
    look = {"color": "0.45", "marker": "+", "linestyle": "none", "markersize": size}
    return Curve([(time, values)], {**look, "label": label, "zorder": 3})


def show_scheme(name: str, names: Sequence[str], line: Line, look: Look) -> Curve:
    """Make a curve in the colour and line style of the scheme `name`.

    Parameters
    ----------
    name
        Name of the scheme.
    names
        Names of all schemes of the study. The look of a scheme may depend on its place among them.
    line
        Times in s and values of each part of the line between two gaps.
    look
        Further properties of the line for matplotlib, e.g. `linewidth`.
    """
    scheme = style_of(name, names)
    return Curve(line, {"color": scheme.color, "linestyle": scheme.line, **look})


def show_estimate(name: str, names: Sequence[str], line: Line, *, on_top: bool = False) -> Curve:
    """Make the curve of a scheme's estimate, drawn over the curve of the true values.

    Parameters
    ----------
    name
        Name of the scheme, which is also the legend entry.
    names
        Names of all schemes of the study. The look of a scheme may depend on its place among them.
    line
        Times in s and values of each part of the line between two gaps.
    on_top
        Whether to draw the curve over those of the other schemes too.
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

    Parameters
    ----------
    errors
        Name of a scheme -> times in s, shape (n,), and errors at these times, shape (n, 2), with
        the columns x and y.
    names
        Names of all schemes of the study. The look of a scheme may depend on its place among them.
    quantity
        The quantity to which the errors belong, e.g. "position"; a key of `UNITS`.
    view
        First and last time on the horizontal axis, in s.
    bound
        A bound on the absolute error, drawn as two dotted lines, above and below zero; None draws
        no bound.
    note
        Text above the panel; "" means no text.
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

    Parameters
    ----------
    errors
        Name of a scheme -> times in s, shape (n,), and errors at these times, shape (n, 2), with
        the columns x and y. The times cover the whole record in equal steps from 0 s.
    names
        Names of all schemes of the study. The look of a scheme may depend on its place among them.
    quantity
        The quantity to which the errors belong, e.g. "position"; a key of `UNITS`.
    end
        The last time on the horizontal axis, i.e. the end of the record, in s.
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
