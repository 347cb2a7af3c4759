"""The best scheme as a smooth function of two conditions, where it is known without records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.results.conditions import Condition

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Contour levels: by how many per cent the runner-up is worse.
MARGINS = (10, 50, 200, 1000)
#: A region smaller than this fraction of the map has no room for its name.
LEAST_REGION = 0.008


@dataclass(frozen=True)
class Field:
    """The data of a smooth map; arrays are (columns, lines).

    Attributes
    ----------
    across, upwards
        The two conditions.
    columns, lines
        Their values, increasing, at least two of each.
    values
        (schemes, columns, lines): the expected MSE.
    best
        The number of the scheme of least value.
    excess
        By how many per cent the runner-up's value is larger; NaN without a runner-up.
    distinguishable
        Whether best and runner-up differ by more than `resolution` (relative).
    resolution
        The relative accuracy of the values.
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
    """Draw the map.

    Parameters
    ----------
    field
        The data.
    schemes
        The schemes compared.
    title
        Of the figure.
    origin
        A sentence for the footnote on the origin of the values.
    coinciding
        Groups of schemes with the same values; the map shows the last name of each.
    """
    with style.context():
        figure = style.new_figure(7.6, 5.8)
        axes = figure.add_subplot()
        _draw_regions(axes, field, schemes)
        _draw_boundaries(axes, field)
        _draw_margins(axes, field)
        if field.across.scale == "log":
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter("{x:g}")
        if field.upwards.scale == "log":
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter("{x:g}")
        axes.set_xlabel(field.across.title)
        axes.set_ylabel(field.upwards.title)
        axes.grid(visible=False)
        axes.set_title(title, loc="left")
        _add_legend(figure, field, schemes, coinciding)
        style.footnote(figure, _explain(field, origin, coinciding))
    return figure


def _draw_regions(axes: Axes, field: Field, schemes: Sequence[str]) -> None:
    from matplotlib.colors import ListedColormap

    colors = [style_of(name, schemes).color for name in schemes]
    axes.pcolormesh(
        field.columns, field.lines, field.best.T, cmap=ListedColormap(colors), vmin=-0.5,
        vmax=len(schemes) - 0.5, shading="nearest", rasterized=True,
    )  # fmt: skip
    for number, name in enumerate(schemes):
        won = field.best == number
        if won.mean() > LEAST_REGION:
            i, j = _find_middle(won)
            text: Any = {"ha": "center", "va": "center", "fontsize": 12, "fontweight": "bold"}
            look = style_of(name, schemes)
            box = {"facecolor": look.color, "edgecolor": "none", "pad": 2.0}
            place = field.columns[i], field.lines[j]
            axes.text(*place, name, color=look.text_color, bbox=box, zorder=5, **text)
    unclear = ~field.distinguishable
    if unclear.any():
        axes.contourf(
            field.columns, field.lines, unclear.T.astype(float), [0.5, 1.5], colors="none",
            hatches=["////"],
        )  # fmt: skip
    axes.set_xlim(field.columns[0], field.columns[-1])
    axes.set_ylim(field.lines[0], field.lines[-1])


def _draw_boundaries(axes: Axes, field: Field) -> None:
    """Draw lines where a scheme equals the best of the schemes that do not coincide with it."""
    values = field.values
    for number in range(len(values)):
        others = np.delete(values, number, axis=0)
        alike = np.max(np.abs(others / values[number] - 1.0), axis=(1, 2)) < field.resolution
        if len(others[~alike]):
            ahead = np.log(others[~alike].min(axis=0) / values[number])
            if ahead.min() < 0.0 < ahead.max():
                axes.contour(
                    field.columns, field.lines, ahead.T, [0.0], colors="black", linewidths=1.4
                )


def _draw_margins(axes: Axes, field: Field) -> None:
    """Draw contours of how much worse the runner-up is."""
    excess = field.excess
    if not np.all(np.isfinite(excess)):
        return
    levels = [level for level in MARGINS if excess.min() < level < excess.max()]
    if levels:
        lines = axes.contour(
            field.columns, field.lines, excess.T, levels, colors="black", linewidths=0.6,
            linestyles="--",
        )  # fmt: skip
        axes.clabel(lines, fmt="%g %%", fontsize=7)


def _find_middle(region: Array) -> tuple[int, int]:
    """The cell of a region that is farthest from its edge."""
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return int(i), int(j)


def _add_legend(
    figure: Figure, field: Field, schemes: Sequence[str], coinciding: Sequence[Sequence[str]]
) -> None:
    from matplotlib.patches import Patch

    hidden = {name for group in coinciding for name in group[:-1]}
    handles = [
        Patch(color=style_of(name, schemes).color,
              label=f"{name}: {_describe_share(float(np.mean(field.best == number)))}")
        for number, name in enumerate(schemes)
        if name not in hidden
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)


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
