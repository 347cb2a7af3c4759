"""Draw how the errors of single records are distributed: a box for each scheme, in a few cells."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.results.conditions import Condition, Value, order_values, select

if TYPE_CHECKING:
    from owtsweep.results.cube import Cube

NAME = "distributions"
#: With fewer records per cell than this, no figure is drawn.
LEAST_RECORDS = 4
#: With at most this many records per cell, each is drawn as a point.
MOST_POINTS = 30
#: Percentiles at the ends of the whiskers.
WHISKERS = (5.0, 95.0)
#: An axis whose ends have a greater ratio has numbers at powers of ten alone.
WIDE = 30.0
#: Width of a panel, height of a box, and what a panel and the figure have beside the boxes, inches.
PANEL, BOX, BESIDE_BOXES, BESIDE_PANELS = 3.6, 0.22, 0.75, 1.2


def collect(cube: Cube, criterion: str, window: str) -> pd.DataFrame:
    """Return the errors of single records in a few cells of a run's map.

    The cells are at the first, the middle and the last value of each of one or two conditions. The
    table has a row for each scheme, cell and record, and the columns scheme, conditions, error. A
    record counts if all schemes of the cell have it, so that boxes can stand side by side.
    Raise `InputError` if the criterion was not measured, or no cell has `LEAST_RECORDS` records.
    """
    if criterion not in cube.measures or len(cube.replicates) < LEAST_RECORDS:
        raise InputError(
            f"grid.replicates: distributions of {criterion} need {LEAST_RECORDS} records per cell "
            f"or more; this run has {len(cube.replicates)}"
        )
    parts = []
    for *outer, last in product(*(_choose(len(levels)) for levels in cube.levels)):
        place = tuple(outer)
        cell = cube.name_outer(place) | {cube.names[-1]: cube.levels[-1][last]}
        shared = cube.find_shared(place)[last]
        values = cube.values_of(place, criterion, window)[:, last]
        for name, of_scheme in zip(cube.schemes, values, strict=True):
            errors = of_scheme[np.isfinite(of_scheme) & shared]
            parts.append(pd.DataFrame({"scheme": name, **cell, "error": errors}))
    return pd.concat(parts, ignore_index=True)


def _choose(count: int) -> list[int]:
    return sorted({0, count // 2, count - 1})


def draw(cube: Cube, criterion: str, window: str, *, title: str, tuning: str, label: str) -> Figure:
    """Draw the errors of single records that `collect` returns.

    There is one panel per cell, and in it one box per scheme, from top to bottom. The first
    condition runs from left to right, the second from bottom to top. `label` is that of the axes of
    errors, which are logarithmic.
    """
    errors, schemes = collect(cube, criterion, window), cube.schemes
    across, *rest = cube.conditions
    columns = _list_values(errors, across)
    lines: list[dict[Condition, Value]] = [{}]
    if rest:
        lines = [{rest[0]: value} for value in reversed(_list_values(errors, rest[0]))]
    figure = style.new_figure(
        max(7.2, 1.4 + PANEL * len(columns)),
        BESIDE_PANELS + (BESIDE_BOXES + BOX * len(schemes)) * len(lines),
    )
    grid = figure.subplots(len(lines), len(columns), squeeze=False, sharex="row", sharey=True)
    for line, row in zip(lines, grid, strict=True):
        for value, axes in zip(columns, row, strict=True):
            cell = {across: value, **line}
            _draw_panel(axes, select(errors, {c.name: v for c, v in cell.items()}), schemes)
            named = ", ".join(f"{c.word} {c.show(v)}" for c, v in cell.items())
            axes.set_title(named, loc="left", fontsize=9)
    for row in grid:
        _scale(row[0])
    for axes in grid[-1]:
        axes.set_xlabel(label)
    title = f"{title}\n{style.describe_window(window)}, tuning: {tuning}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    counts = errors.groupby(["scheme", *cube.names])["error"].size()
    points = "points: the records" if counts.max() <= MOST_POINTS else "dots: records beyond"
    low, high = WHISKERS
    style.footnote(
        figure,
        f"Each box holds the errors of single records, up to {counts.max()} of them, which all "
        "schemes of the cell have: its middle half, with the median as a line; whiskers: "
        f"{low:g} to {high:g} %; {points}; diamond: the mean, by which the map judges. All schemes "
        "saw the same records, so overlapping boxes do not mean that two schemes cannot be told "
        "apart: see the map.",
    )
    return figure


def _list_values(errors: pd.DataFrame, condition: Condition) -> list[Value]:
    return order_values(errors[condition.name], errors[condition.name].unique())


def _draw_panel(axes: Axes, errors: pd.DataFrame, schemes: Sequence[str]) -> None:
    import seaborn as sns  # takes a second to import

    few = errors.groupby("scheme")["error"].size().max() <= MOST_POINTS
    shared: dict[str, object] = {
        "data": errors, "x": "error", "y": "scheme", "order": schemes, "ax": axes,
    }  # fmt: skip
    colors = {name: style_of(name, schemes).color for name in schemes}
    mean = {"marker": "D", "markerfacecolor": "white", "markeredgecolor": "black", "markersize": 4}
    sns.boxplot(
        **shared, hue="scheme", palette=colors, saturation=1.0, legend=False, whis=WHISKERS,
        showmeans=True, meanprops=mean, showfliers=not few, fliersize=2, linewidth=0.9,
    )  # fmt: skip
    if few:
        # without jitter, which would differ from drawing to drawing
        sns.stripplot(**shared, color="black", size=2.5, alpha=0.6, jitter=False)
    axes.set(xlabel="", ylabel="")


def _scale(axes: Axes) -> None:
    """Make the axis of errors logarithmic, in all panels that share it.

    This comes after the boxes: percentiles and means are of the errors, not of their logarithms.
    """
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if high > WIDE * low else (1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
