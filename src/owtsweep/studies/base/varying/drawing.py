"""Draws the schemes' errors and the Kalman bound over the values of one key, a panel per cell."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from owtsweep.arrays import Array
from owtsweep.figures import curves, style
from owtsweep.figures.palette import style_of
from owtsweep.studies.base.varying.errors import Errors

#: Most panels in a row.
COLUMNS = 3
#: Characters of the title in a line, per inch of the figure's width.
LETTERS = 12.5
#: Characters of a line beside a panel.
LONGEST_LABEL = 40
#: A space at which no line is broken.
NO_BREAK = "\N{NO-BREAK SPACE}"
#: Most values that each have a tick of their own on a linear axis.
MOST_TICKS = 12
#: Half the width that a text's marks take, where neighbouring texts are 1 apart.
HALF_WIDTH = 0.35
BOUND_LINE: style.Look = {"color": "black", "linestyle": ":", "linewidth": 1.8, "zorder": 3.5}


def draw(errors: Errors) -> Figure:
    """Draw the error of each scheme, and of those apart, over the values of the key."""
    count = len(errors.cells)
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    width = 2.6 + 4.6 * columns + (1.0 if columns == 1 else 0.0)
    figure = style.new_figure(width, 1.6 + 3.4 * rows)
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for number, axes in enumerate(grid.flat):
        if number >= count:
            axes.set_visible(False)
            continue
        _draw_panel(axes, errors, number)
    for axes in grid[:, 0]:
        axes.set_ylabel(textwrap.fill(errors.title, LONGEST_LABEL))
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False)
    whole = [fact.replace(" ", NO_BREAK) for fact in errors.facts]
    facts = textwrap.fill(f"At all values: {'; '.join(whole)}", int(LETTERS * width))
    figure.suptitle(
        f"Settled error over {errors.along.label}\n{facts}", x=0.01, ha="left", fontsize=10
    )
    style.footnote(figure, " ".join([*errors.footnotes, *errors.notes]))
    return figure


def _draw_panel(axes: Axes, errors: Errors, number: int) -> None:
    _draw_errors(axes, errors, number)
    curves.scale_axes(axes, errors.along, errors.values)
    if errors.along.scale == "linear" and not isinstance(errors.values[0], str):
        every = -(-len(errors.values) // MOST_TICKS)
        axes.set_xticks([float(value) for value in errors.values[::every]])
        axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_title(errors.cells[number], loc="left", fontsize=10)


def _draw_errors(axes: Axes, errors: Errors, number: int) -> None:
    """Draw schemes, those apart and the bound: as curves over numbers, as marks over texts."""
    of_texts = isinstance(errors.values[0], str)
    place = np.arange(len(errors.values)) if of_texts else np.array(errors.values, dtype=float)
    aside = np.linspace(-0.6, 0.6, len(errors.schemes)) * HALF_WIDTH * of_texts

    def draw_line(level: Array, look: style.Look, label: str) -> None:
        if of_texts:
            axes.hlines(level, place - HALF_WIDTH, place + HALF_WIDTH, label=label, **look)
        else:
            axes.plot(place, level, label=label, **look)

    for n, name in enumerate(errors.names):
        of_name, label = errors.error[n, :, number], style.label_of(name)
        if name in errors.apart:
            draw_line(of_name, curves.thin_line(style_of(name, errors.apart)), label)
            continue
        drawn = style_of(name, errors.schemes)
        # of lines that coincide, the best scheme's is seen
        on_top = float(errors.best_scheme[n, :, number].mean())
        axes.plot(
            place + aside[n], of_name, color=drawn.color,
            linestyle="none" if of_texts else drawn.line, marker=drawn.marker,
            markersize=6.0 if of_texts else 4.5, zorder=2.0 + on_top, label=label,
        )  # fmt: skip
        _draw_interval(axes, errors, place + aside[n], n, number)
    if errors.bound is not None:
        draw_line(errors.bound, BOUND_LINE, "Kalman bound")


def _draw_interval(axes: Axes, errors: Errors, place: Array, scheme: int, cell: int) -> None:
    """Draw the 95 % intervals of a scheme as vertical lines, if there are any."""
    if errors.interval is None:
        return
    low, high = (end[scheme, :, cell] for end in errors.interval)
    color = style_of(errors.schemes[scheme], errors.schemes).color
    # a logarithmic axis has no zero
    low = np.maximum(low, curves.LOWEST * errors.error[scheme, :, cell])
    axes.vlines(place, low, high, color=color, linewidth=1.0)
