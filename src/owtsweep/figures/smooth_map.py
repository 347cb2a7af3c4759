"""Draw a finely resolved map of the best scheme, that of the least expected MSE."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.figures import margin, style
from owtsweep.figures.best_scheme_map import HATCH
from owtsweep.figures.margin import add_legend, make_entry
from owtsweep.figures.palette import style_of, text_color_on
from owtsweep.results.conditions import Condition

#: Contour levels: by how many per cent the runner-up's MSE is larger than the best scheme's.
MARGINS = (10, 50, 200, 700)
#: A region smaller than this fraction of the map has no room for its name.
LEAST_REGION = 0.008


@dataclass(frozen=True)
class Field:
    """The data of a finely resolved map of the best scheme over two conditions.

    The runner-up is the scheme of the second least expected MSE. Arrays without other shape have
    the shape (columns, lines).

    columns, lines: the values of `across` and of `upwards`, increasing, at least two of each.
    values: the expected MSE of each scheme, shape (schemes, columns, lines).
    best: Index of the best scheme; -1 where a baseline beats every scheme.
    excess: By how many per cent the runner-up's MSE is larger than that of the best scheme; NaN if
        there is no runner-up.
    distinguishable: whether the two differ by more than `resolution`, the relative accuracy of
        `values`.
    baseline: Index of the baseline that beats every scheme; -1 where none does.
    lead: Logarithm of the best scheme's MSE divided by that of the best baseline. A baseline beats
        every scheme where `lead` is more than `resolution`.
    """

    across: Condition
    upwards: Condition
    columns: Array
    lines: Array
    values: Array
    best: NDArray[np.intp]
    excess: Array
    distinguishable: NDArray[np.bool_]
    resolution: float
    baseline: NDArray[np.intp]
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
    """Draw a finely resolved map of the best scheme over two conditions.

    Full lines separate the regions of the best schemes. Dashed contours show by how many per cent
    the runner-up's MSE is larger than that of the best scheme.

    schemes, baselines: Names, in the order of `field.values` and `field.baseline`.
    origin: a sentence for the footnote that says where the data come from.
    coinciding: Groups of names of schemes with equal values. The map shows each group under the
        last of its names; the footnote says so of the groups that are best somewhere.
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
    named = {name for number, name in enumerate(schemes) if (field.best == number).any()}
    groups = style.choose_groups(coinciding, named)
    hidden = {name for group in groups for name in group[:-1]}
    handles = []
    for names, best in ((schemes, field.best), (baselines, field.baseline)):
        for number, name in enumerate(names):
            share = float(np.mean(best == number))
            if name not in hidden and (share > 0.0 or names is schemes):
                handles.append(make_entry(name, names, f"{name}: {_describe_share(share)}"))
    add_legend(figure, handles, columns=2)
    style.footnote(figure, " ".join([_explain(field, origin, groups), *notes]))
    return figure


def _draw_regions(axes: Axes, field: Field, schemes: Sequence[str]) -> None:
    ratio = np.sqrt(1.0 + field.excess / 100.0)  # of errors, not of their squares
    _fill(axes, field, field.best, ratio, schemes, zorder=1)
    unclear = ~field.distinguishable
    if unclear.any():
        cover: style.Look = {"levels": [0.5, 1.5], "colors": "none", "hatches": [HATCH]}
        axes.contourf(field.columns, field.lines, unclear.T.astype(float), **cover)
    axes.set_xlim(field.columns[0], field.columns[-1])
    axes.set_ylim(field.lines[0], field.lines[-1])


def _cover_baselines(axes: Axes, field: Field, baselines: Sequence[str]) -> None:
    """Cover the parts of the map where a baseline beats every scheme, and name the baseline.

    The fill shows by how much the best scheme's MSE is larger than the baseline's.
    """
    covered = field.baseline >= 0
    if not covered.any():
        return
    _fill(axes, field, field.baseline, np.exp(0.5 * field.lead), baselines, zorder=6)
    if not covered.all():
        edge: style.Look = {"colors": "black", "linewidths": 1.4, "zorder": 7}
        axes.contour(field.columns, field.lines, field.lead.T, [field.resolution], **edge)


def _fill(
    axes: Axes,
    field: Field,
    best: NDArray[np.intp],
    ratio: Array,
    names: Sequence[str],
    *,
    zorder: float,
) -> None:
    """Fill the regions of names, shaded by `ratio`, and write each name into its region.

    best: Index of the name of a point, shape (columns, lines); -1: its fill is left as it is.
    """
    looks = [style_of(name, names) for name in names]
    fill = margin.fill_regions(best, ratio, [look.color for look in looks])
    cover = np.dstack([fill, best.T >= 0])
    axes.pcolormesh(
        field.columns, field.lines, cover, shading="nearest", rasterized=True, zorder=zorder
    )
    for number, (name, look) in enumerate(zip(names, looks, strict=True)):
        region = best == number
        if region.mean() > LEAST_REGION:  # it has room for the name
            i, j = _find_middle(region)
            axes.text(
                field.columns[i], field.lines[j], name, color=text_color_on(look.color),
                ha="center", va="center", fontsize=12, fontweight="bold", zorder=zorder + 2,
                bbox={"facecolor": look.color, "edgecolor": "none", "pad": 2.0},
            )  # fmt: skip


def _draw_boundaries(axes: Axes, field: Field) -> None:
    """Draw, for each scheme, the line where the scheme's MSE equals the least MSE of the others.

    Schemes whose MSE agree everywhere, up to `field.resolution`, are not compared with each other.
    """
    look: style.Look = {"levels": [0.0], "colors": "black", "linewidths": 1.4}
    for number, values in enumerate(field.values):
        others = np.delete(field.values, number, axis=0)
        alike = np.max(np.abs(others / values - 1.0), axis=(1, 2)) < field.resolution
        if not alike.all():
            ahead = np.log(others[~alike].min(axis=0) / values)
            if ahead.min() < 0.0 < ahead.max():
                axes.contour(field.columns, field.lines, ahead.T, **look)


def _draw_margins(axes: Axes, field: Field) -> None:
    """Draw contours of `field.excess` at the levels `MARGINS`, if it is finite everywhere."""
    excess = field.excess
    if not np.all(np.isfinite(excess)):
        return
    levels = [level for level in MARGINS if excess.min() < level < excess.max()]
    if levels:
        look: style.Look = {"colors": "black", "linewidths": 0.8, "linestyles": "--"}
        lines = axes.contour(field.columns, field.lines, excess.T, levels, **look)
        lines.set_path_effects([withStroke(linewidth=2.4, foreground="white", alpha=0.7)])
        for label in axes.clabel(lines, fmt="+%g %%", fontsize=8):
            label.set_path_effects([withStroke(linewidth=2.5, foreground="white")])


def _find_middle(region: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the column and the line of the point in a region that is farthest from its edge."""
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return int(i), int(j)


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
