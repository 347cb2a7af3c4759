"""Draw a fine map of the best scheme over two conditions, from expected values of the MSE."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.best_scheme_map import HATCH
from owtsweep.figures.palette import style_of
from owtsweep.results.conditions import Condition

#: Contour levels: by how many per cent the runner-up's MSE is larger than the best scheme's.
MARGINS = (10, 50, 200, 1000)
#: A region smaller than this fraction of the map has no room for its name.
LEAST_REGION = 0.008


@dataclass(frozen=True)
class Field:
    """The data of a smooth map.

    Attributes
    ----------
    across, upwards
        The conditions on the horizontal and on the vertical axis.
    columns, lines
        The values of `across` and of `upwards`, increasing, at least two of each.
    values
        The expected MSE, shape (schemes, columns, lines).
    best
        Index of the scheme of least expected MSE, shape (columns, lines); -1 where a baseline
        beats it.
    excess
        By how many per cent the runner-up's MSE is larger, shape (columns, lines); NaN without a
        runner-up.
    distinguishable
        Whether best and runner-up differ by more than `resolution`, shape (columns, lines).
    resolution
        The relative accuracy of `values`.
    baseline
        Index of the baseline that beats every scheme, shape (columns, lines); -1 where none does.
    lead
        Logarithm of the best scheme's MSE divided by that of the best baseline, shape
        (columns, lines). A baseline beats every scheme where this is more than `resolution`.
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
    baseline: NDArray[np.integer[Any]]
    lead: Array


def draw(
    field: Field,
    schemes: Sequence[str],
    *,
    title: str,
    origin: str,
    coinciding: Sequence[Sequence[str]] = (),
    baselines: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Figure:
    """Draw the regions of the best schemes, with lines between them and contours of the margin.

    Parameters
    ----------
    field
        The data.
    schemes
        Names of the schemes, in the order of `field.values`.
    title
        Title of the figure.
    origin
        A sentence for the footnote that says where the values come from.
    coinciding
        Groups of schemes with equal values. The map shows each group under the last of its names.
    baselines
        Names of the baselines, to which `field.baseline` refers.
    notes
        Sentences at the end of the footnote.
    """
    figure = style.new_figure(7.6, 5.8)
    axes = figure.add_subplot()
    _draw_regions(axes, field, schemes)
    _draw_boundaries(axes, field)
    _draw_margins(axes, field)
    _cover_baselines(axes, field, baselines)
    axes.set(xscale=field.across.scale, xlabel=field.across.title)
    axes.set(yscale=field.upwards.scale, ylabel=field.upwards.title)
    for axis, condition in ((axes.xaxis, field.across), (axes.yaxis, field.upwards)):
        if condition.scale == "log":
            axis.set_major_formatter("{x:g}")
    axes.grid(visible=False)
    axes.set_title(title, loc="left")
    handles = _make_legend(field, schemes, coinciding)
    for number, name in enumerate(baselines):
        share = float(np.mean(field.baseline == number))
        if share > 0.0:
            label = f"{name}: {_describe_share(share)}"
            handles.append(Patch(color=style_of(name, baselines).color, label=label))
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    style.footnote(figure, " ".join([_explain(field, origin, coinciding), *notes]))
    return figure


def _draw_regions(axes: Axes, field: Field, schemes: Sequence[str]) -> None:
    looks = [style_of(name, schemes) for name in schemes]
    axes.pcolormesh(
        field.columns, field.lines, field.best.T, vmin=-0.5, vmax=len(schemes) - 0.5,
        cmap=ListedColormap([look.color for look in looks]), shading="nearest", rasterized=True,
    )  # fmt: skip
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


def _cover_baselines(axes: Axes, field: Field, baselines: Sequence[str]) -> None:
    """Cover the parts of the map where a baseline beats every scheme, and name the baseline."""
    text: Any = {"ha": "center", "va": "center", "fontsize": 12, "fontweight": "bold", "zorder": 8}
    for number, name in enumerate(baselines):
        won, look = field.baseline == number, style_of(name, baselines)
        if won.any():
            cover = np.ma.masked_where(~won, won)
            axes.pcolormesh(
                field.columns, field.lines, cover.T, cmap=ListedColormap([look.color]),
                shading="nearest", rasterized=True, zorder=6,
            )  # fmt: skip
        if won.mean() > LEAST_REGION:
            i, j = _find_middle(won)
            axes.text(field.columns[i], field.lines[j], name, color=look.text_color, **text)
    covered = field.baseline >= 0
    if covered.any() and not covered.all():
        edge: dict[str, Any] = {"colors": "black", "linewidths": 1.4, "zorder": 7}
        axes.contour(field.columns, field.lines, field.lead.T, [field.resolution], **edge)


def _draw_boundaries(axes: Axes, field: Field) -> None:
    """Draw for each scheme the line where the scheme's MSE equals the least MSE of the others.

    The others are those whose MSE differs, somewhere on the map, by more than the field's
    resolution.
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
    """Draw contours of how many per cent larger the runner-up's MSE is than the best scheme's."""
    excess = field.excess
    if not np.all(np.isfinite(excess)):
        return
    levels = [level for level in MARGINS if excess.min() < level < excess.max()]
    if levels:
        look: dict[str, Any] = {"colors": "black", "linewidths": 0.6, "linestyles": "--"}
        lines = axes.contour(field.columns, field.lines, excess.T, levels, **look)
        axes.clabel(lines, fmt="%g %%", fontsize=7)


def _find_middle(region: Array) -> tuple[int, int]:
    """Return column and line of the cell of a region that is farthest from the region's edge.

    `region` is a mask of shape (columns, lines).
    """
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return int(i), int(j)


def _make_legend(
    field: Field, schemes: Sequence[str], coinciding: Sequence[Sequence[str]]
) -> list[Patch]:
    hidden = {name for group in coinciding for name in group[:-1]}
    handles = []
    for number, name in enumerate(schemes):
        if name not in hidden:
            share = _describe_share(float(np.mean(field.best == number)))
            color = style_of(name, schemes).color
            handles.append(Patch(color=color, label=style.label_of(f"{name}: {share}")))
    return handles


def _describe_share(won: float) -> str:
    if won == 0.0:
        return "best nowhere"
    return "under 1 % of the map" if won < 0.01 else f"{100 * won:.0f} % of the map"


def _explain(field: Field, origin: str, coinciding: Sequence[Sequence[str]]) -> str:
    sentences = [
        "Full lines: where the best scheme changes. Dashed: by how many per cent the runner-up's"
        f" MSE is larger. {origin}"
    ]
    if np.mean(~field.distinguishable) > LEAST_REGION:
        sentences.append(f"Hatched: the two differ by less than {100 * field.resolution:g} %.")
    return " ".join([*sentences, *style.explain_coinciding(coinciding)])
