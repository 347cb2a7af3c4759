"""Draw quantities of a record over time: one panel for x, one for y, and a panel of errors below.

The lowest panel usually shows the errors of x, or the accumulated errors of x and y. A study
defines what each panel shows (`Panel`). This module defines layout, legend and looks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.lines import Line, clip, make_line
from owtsweep.figures.palette import style_of

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
    """A line and its matplotlib properties; a `label` among them makes an entry in the legend."""

    line: Line
    look: Mapping[str, Any]

    def draw(self, axes: Axes) -> None:
        """Draw the pieces of the line; only the first piece carries the label."""
        look = dict(self.look)
        for time, values in self.line:
            axes.plot(time, values, **look)
            look.pop("label", None)


@dataclass(frozen=True)
class Level:
    """A horizontal line at `value`, dotted if `bound` is true."""

    value: float
    bound: bool = False

    def draw(self, axes: Axes) -> None:
        """Draw the line over the whole width of the axes."""
        width, dashes = (1.0, ":") if self.bound else (0.8, "-")
        axes.axhline(self.value, color="0.3", linewidth=width, linestyle=dashes)


@dataclass(frozen=True)
class Band:
    """The area between the series `low` and `high`; all arrays have shape (n,), time is in s."""

    time: Array
    low: Array
    high: Array
    color: str

    def draw(self, axes: Axes) -> None:
        """Fill the area between both series."""
        axes.fill_between(self.time, self.low, self.high, color=self.color, alpha=0.15, linewidth=0)


@dataclass(frozen=True)
class Panel:
    """The contents of one panel.

    Attributes
    ----------
    label
        Label of the vertical axis.
    marks
        The things to draw, in this order.
    view
        First and last time shown, in s.
    limits
        Lower and upper limit of the vertical axis; None for a limit that follows from the values.
    note
        Text above the panel; "" for none.
    note_color
        Colour of the note.
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
    """Draw two or three panels below each other; the legend lists the marks of the uppermost panel.

    Parameters
    ----------
    panels
        The panels from top to bottom.
    title, footnote
        Texts above and below the panels.
    time_label
        Label of the lowest panel's horizontal axis.
    shared
        Whether all panels show the same span of time; then only the lowest has tick labels.
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
    """Return the name of a quantity, such as "bias", as the beginning of a title."""
    return NAMES.get(quantity, quantity.capitalize())


def show_truth(line: Line, label: str = "truth") -> Curve:
    """Make the curve of the true values of a quantity."""
    return Curve(line, {"color": "black", "linewidth": 1.4, "label": label})


def show_measurement(line: Line) -> Curve:
    """Make the curve of the IMU's measurements."""
    return Curve(line, {"color": "0.75", "linewidth": 0.6, "label": "IMU"})


def show_fixes(time: Array, values: Array, *, label: str, size: float) -> Curve:
    """Make the marks of a slow sensor's position fixes at the times at which they arrived.

    `time` in s and `values` have shape (n,); `size` is the size of a mark in points.
    """
    look = {"color": "0.45", "marker": "+", "linestyle": "none", "markersize": size}
    return Curve([(time, values)], {**look, "label": label, "zorder": 3})


def show_scheme(name: str, names: Sequence[str], line: Line, **look: Any) -> Curve:
    """Make a curve in the colour and line style of the scheme `name`.

    Parameters
    ----------
    name
        Name of the scheme.
    names
        All schemes of the study, which determine the look of schemes without a reserved look.
    line
        The line to draw.
    **look
        Further matplotlib properties.
    """
    scheme = style_of(name, names)
    return Curve(line, {"color": scheme.color, "linestyle": scheme.line, **look})


def show_estimate(name: str, names: Sequence[str], line: Line, *, on_top: bool = False) -> Curve:
    """Make the curve of a scheme's estimate, drawn above the truth; arguments as `show_scheme`.

    `on_top` draws it above the other schemes' too.
    """
    zorder = ON_TOP if on_top else 2.5
    return show_scheme(name, names, line, linewidth=1.2, label=style.label_of(name), zorder=zorder)


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
        Scheme -> its errors.
    names
        All schemes of the study, which determine the looks.
    quantity
        The quantity to which the errors belong, a key of `UNITS`.
    view
        First and last time shown, in s.
    bound
        A bound on the error, marked on both sides of zero; None for none.
    note
        Text above the panel.
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
        Scheme -> its errors over the whole record, in equal steps from 0 s.
    names
        All schemes of the study, which determine the looks.
    quantity
        The quantity to which the errors belong, a key of `UNITS`.
    end
        End of the record in s.
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
