"""The best-scheme maps of several runs as small multiples, with the HME1/HME2 boundary on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from owtsweep.comparing.cells import Common
from owtsweep.comparing.panels import Panels
from owtsweep.figures import style
from owtsweep.figures.best_scheme_map import HATCH, NO_RESULT, draw_cells
from owtsweep.figures.palette import style_of
from owtsweep.studies.hub.figures.two_maps import LOWER, UPPER, place

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINE: dict[str, Any] = {
    "color": "black", "linewidth": 1.6, "marker": "o", "markersize": 3.5,
    "markeredgecolor": "white", "markeredgewidth": 0.6, "zorder": 5,
}  # fmt: skip


def draw(
    panels: Panels,
    best: Sequence[pd.DataFrame],
    boundaries: pd.DataFrame,
    shared: Common,
    *,
    subtitle: str,
) -> Figure:
    """Draw one map per run.

    Parameters
    ----------
    panels
        Where each run stands.
    best
        Per run the rows of its best-scheme table in the common cells.
    boundaries
        The table of boundaries, with the index of the run in `index`.
    shared
        What the runs have in common.
    subtitle
        What the maps judge.
    """
    from matplotlib.patches import Patch

    rows, columns = len(panels.runs), len(panels.runs[0])
    width = min(max(2.9, 0.5 * len(shared.natural_periods)), 5.0)
    height = min(max(2.1, 0.27 * len(shared.amplitudes)), 4.0)
    with style.context():
        figure = style.new_figure(max(7.6, 0.9 + width * columns), 1.9 + (height + 0.5) * rows)
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        hatched = hole = line = False
        for row, (indices, titles) in enumerate(zip(panels.runs, panels.titles, strict=True)):
            for column, (index, title) in enumerate(zip(indices, titles, strict=True)):
                axes = grid[row][column]
                if index is None:
                    _nothing(axes, "no run" if len(panels.titles[0][0].splitlines()) > 1 else "")
                    continue
                cells = best[index].to_dict("records")
                draw_cells(
                    axes, cells, shared.schemes, shared.natural_periods, shared.amplitudes,
                    labels="none",
                )  # fmt: skip
                axes.set_title(title, loc="left", fontsize=9)
                axes.label_outer()
                hatched |= not all(cell["distinguishable"] for cell in cells)
                hole |= len(cells) < len(shared.cells)
                line |= _boundary(axes, boundaries[boundaries["index"] == index], shared)
        for row, indices in enumerate(panels.runs):  # beside an empty panel, likewise
            leftmost = next(c for c, index in enumerate(indices) if index is not None)
            grid[row][leftmost].tick_params(labelleft=True)
            grid[row][leftmost].set_ylabel("motion amplitude (m)")
        for column in range(columns):  # below an empty panel the axis would have no labels
            _label_lowest([grid[row][column] for row in range(rows)], panels, column)
        handles: list[Any] = [
            Patch(facecolor=style_of(name, shared.schemes).color, label=name)
            for name in shared.schemes
        ]
        if hatched:
            handles.append(
                Patch(facecolor="0.6", edgecolor="white", hatch=HATCH, label="not distinguishable")
            )
        if hole:
            handles.append(Patch(facecolor=NO_RESULT, label="no result"))
        if line:
            handles += grid[0][0].plot([], [], **LINE, label=f"{LOWER}/{UPPER} boundary")
        figure.legend(
            handles=handles,
            title=f"Best scheme {subtitle}",
            title_fontsize=11,
            loc="outside upper left",
            alignment="left",
            ncols=4,
            frameon=False,
        )
        style.footnote(figure, _explanation(hatched, line))
    return figure


def _nothing(axes: Axes, text: str) -> None:
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color="0.4")


def _label_lowest(column: Sequence[Axes], panels: Panels, number: int) -> None:
    lowest = max(row for row, line in enumerate(panels.runs) if line[number] is not None)
    column[lowest].tick_params(labelbottom=True)
    column[lowest].set_xlabel("natural period (s)")


def _boundary(axes: Axes, found: pd.DataFrame, shared: Common) -> bool:
    exists = found[(found["wins"] == "") & found["boundary"].notna()]
    if exists.empty:
        return False
    # A line that skips a period without a boundary would claim one there.
    line = [float("nan")] * len(shared.natural_periods)
    heights = place(exists["boundary"].to_numpy(dtype=float), shared.amplitudes)
    for period, height in zip(exists["natural_period"], heights, strict=True):
        line[shared.natural_periods.index(period)] = float(height)
    axes.plot(range(len(line)), line, **{**LINE, "color": "white", "linewidth": 3.6})
    axes.plot(range(len(line)), line, **LINE)
    return True


def _explanation(hatched: bool, line: bool) -> str:
    parts = []
    if hatched:
        parts.append(
            "Hatched: the data do not tell best and next best apart (paired difference, 95 %,"
            " Holm's correction over the cells of one map)."
        )
    if line:
        parts.append(
            f"Boundary: amplitude at which {LOWER} and {UPPER} have the same mean MSE, placed"
            " logarithmically between rows and at the map's edge if it lies beyond; periods without"
            " a point have no boundary."
        )
    return " ".join(parts) or "Every cell's best scheme is told from the next."
