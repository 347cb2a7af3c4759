"""Draw a finely resolved map of the best scheme over two conditions.

The best scheme is the scheme of the least expected mean squared error (MSE).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.figures import margin, style
from owtsweep.figures.best_scheme_map import HATCH
from owtsweep.figures.palette import style_of
from owtsweep.figures.shades import Shades, add_legend
from owtsweep.results.conditions import Condition

#: Contour levels: by how many per cent the runner-up's MSE is larger than the best scheme's.
MARGINS = (10, 50, 200, 700)
#: A region smaller than this fraction of the map has no room for its name.
LEAST_REGION = 0.008


@dataclass(frozen=True)
class Field:
    """The data of a finely resolved map of the best scheme over two conditions.

    The runner-up is the scheme of the second least expected MSE.

    Attributes
    ----------
    across, upwards
        The conditions on the horizontal and on the vertical axis.
    columns, lines
        The values of `across` and of `upwards`, increasing, at least two of each.
    values
        The expected MSE of each scheme, shape (schemes, columns, lines).
    best
        Index of the scheme of the least expected MSE, shape (columns, lines).
    excess
        By how many per cent the runner-up's MSE is larger than that of the best scheme, shape
        (columns, lines); NaN if there is no runner-up.
    distinguishable
        Whether the MSE of the best scheme and of the runner-up differ by more than `resolution`,
        shape (columns, lines).
    resolution
        The relative accuracy of `values`, e.g. 0.01 for 1 %.
    """

    across: Condition
    upwards: Condition
    columns: Array
    lines: Array
    values: Array
    best: NDArray[np.integer[Any]]
    excess: Array
    distinguishable: NDArray[np.bool_]
    resolution: float


def draw(
    field: Field,
    schemes: Sequence[str],
    *,
    title: str,
    origin: str,
    coinciding: Sequence[Sequence[str]] = (),
) -> Figure:
    """Draw a finely resolved map of the best scheme over two conditions.

    Full lines separate the regions of the best schemes. Dashed contours show by how many per cent
    the runner-up's MSE is larger than that of the best scheme.

    Parameters
    ----------
    field
        The data of the map.
    schemes
        Names of the schemes, in the order of the first axis of `field.values`.
    title
        Title of the figure.
    origin
        A sentence for the footnote that says where the data come from.
    coinciding
        Groups of names of schemes with equal values. The map shows each group under the last of its
        names.
    """
    figure = style.new_figure(7.6, 5.8)
    axes = figure.add_subplot()
    _draw_regions(axes, field, schemes)
    _draw_boundaries(axes, field)
    _draw_margins(axes, field)
    axes.set(xscale=field.across.scale, xlabel=field.across.title)
    axes.set(yscale=field.upwards.scale, ylabel=field.upwards.title)
    for axis, condition in ((axes.xaxis, field.across), (axes.yaxis, field.upwards)):
        if condition.scale == "log":
            axis.set_major_formatter("{x:g}")
    axes.grid(visible=False)
    axes.set_title(title, loc="left")
    handles = _make_legend(field, schemes, coinciding)
    add_legend(figure, handles, columns=2)
    style.footnote(figure, _explain(field, origin, coinciding))
    return figure


def _draw_regions(axes: Axes, field: Field, schemes: Sequence[str]) -> None:
    looks = [style_of(name, schemes) for name in schemes]
    ratio = 1.0 + field.excess / 100.0
    fill = margin.fill_regions(field.best, ratio, [look.color for look in looks])
    axes.pcolormesh(field.columns, field.lines, fill, shading="nearest", rasterized=True)
    text: Any = {"ha": "center", "va": "center", "fontsize": 12, "fontweight": "bold", "zorder": 5}
    for number, (name, look) in enumerate(zip(schemes, looks, strict=True)):
        won = field.best == number
        if won.mean() > LEAST_REGION:
            i, j = _find_middle(won)
            box = {"facecolor": look.color, "edgecolor": "none", "pad": 2.0}
            place = field.columns[i], field.lines[j]
            axes.text(*place, name, color=look.text_color, bbox=box, **text)
    unclear = ~field.distinguishable
    if unclear.any():
        cover: dict[str, Any] = {"levels": [0.5, 1.5], "colors": "none", "hatches": [HATCH]}
        axes.contourf(field.columns, field.lines, unclear.T.astype(float), **cover)
    axes.set_xlim(field.columns[0], field.columns[-1])
    axes.set_ylim(field.lines[0], field.lines[-1])


def _draw_boundaries(axes: Axes, field: Field) -> None:
    """Draw, for each scheme, the line where the scheme's MSE equals the least MSE of the others.

    Two schemes whose MSE agrees everywhere on the map, up to `field.resolution`, are not compared
    with each other.
    """
    look: dict[str, Any] = {"levels": [0.0], "colors": "black", "linewidths": 1.4}
    for number, values in enumerate(field.values):
        others = np.delete(field.values, number, axis=0)
        alike = np.max(np.abs(others / values - 1.0), axis=(1, 2)) < field.resolution
        if not alike.all():
            ahead = np.log(others[~alike].min(axis=0) / values)
            if ahead.min() < 0.0 < ahead.max():
                axes.contour(field.columns, field.lines, ahead.T, **look)


def _draw_margins(axes: Axes, field: Field) -> None:
    """Draw contours of `field.excess` at the levels `MARGINS`.

    The excess is by how many per cent the runner-up's MSE is larger than that of the best scheme.
    If it is not finite everywhere, nothing is drawn.
    """
    excess = field.excess
    if not np.all(np.isfinite(excess)):
        return
    levels = [level for level in MARGINS if excess.min() < level < excess.max()]
    if levels:
        look: dict[str, Any] = {"colors": "black", "linewidths": 0.8, "linestyles": "--"}
        lines = axes.contour(field.columns, field.lines, excess.T, levels, **look)
        lines.set_path_effects([withStroke(linewidth=2.4, foreground="white", alpha=0.7)])
        for label in axes.clabel(lines, fmt="+%g %%", fontsize=8):
            label.set_path_effects([withStroke(linewidth=2.5, foreground="white")])


def _find_middle(region: Array) -> tuple[int, int]:
    """Return the column and the line of the point in a region that is farthest from its edge.

    `region`, shape (columns, lines), is true at the points of the region.
    """
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return int(i), int(j)


def _make_legend(
    field: Field, schemes: Sequence[str], coinciding: Sequence[Sequence[str]]
) -> list[Shades]:
    hidden = {name for group in coinciding for name in group[:-1]}
    handles = []
    for number, name in enumerate(schemes):
        if name not in hidden:
            share = _describe_share(float(np.mean(field.best == number)))
            color = style_of(name, schemes).color
            handles.append(Shades(color=color, label=style.label_of(f"{name}: {share}")))
    return handles


def _describe_share(won: float) -> str:
    if won == 0.0:
        return "best nowhere"
    return "under 1 % of the map" if won < 0.01 else f"{100 * won:.0f} % of the map"


def _explain(field: Field, origin: str, coinciding: Sequence[Sequence[str]]) -> str:
    sentences = [
        "Full lines: where the best scheme changes. Dashed: by how many per cent the runner-up's"
        " MSE is larger."
    ]
    if np.mean(~field.distinguishable) > LEAST_REGION:
        percent = 100 * field.resolution
        sentences.append(f"Hatched: best and runner-up differ by less than {percent:g} %.")
    sentences.append(origin)
    return " ".join([*sentences, *style.explain_coinciding(coinciding)])
