"""Draw the best-scheme maps of several tunings side by side; all have the same records."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.patheffects import Normal, Stroke

from owtsweep.arrays import Array
from owtsweep.config import AnyConfig
from owtsweep.errors import InputError
from owtsweep.figures import margin, style
from owtsweep.figures.best_scheme_map import ONE_LINE, RUNNER_UP, draw_cells
from owtsweep.figures.margin import list_shades
from owtsweep.figures.plane import Plane
from owtsweep.figures.style import HANDLERS
from owtsweep.results.answer import tell_counts
from owtsweep.results.conditions import Value, select
from owtsweep.studies.hub.contract import list_baselines, scheme_names
from owtsweep.studies.hub.describe import describe_origin, find_alike, find_winners, tell_window
from owtsweep.studies.hub.measures import JUDGED
from owtsweep.studies.hub.worlds import find_world
from owtsweep.sweep.gather import Results

NAME = "best_scheme_maps"
#: Widths and heights in inches: of a column of cells, of a row of cells, and beside the cells.
COLUMN, ROW, BESIDE = (0.75, 1.1), (0.3, 0.5), 1.0
#: Width of the legend, beside the title, and height of a line of the title.
LEGEND, LINE = 2.4, 0.17
#: Width of a letter of the second name.
LETTER = 0.065
#: A map with more cells than this has no text in the cells.
MOST_LABELS = 300


@dataclass(frozen=True)
class Region:
    """A region to outline on a map.

    natural_period: s, increasing, shape (n,).
    low, high: lower and upper edge of the region there (m), shape (n,).
    label, text: the entry of the legend, and the sentences for the footnote.
    """

    natural_period: Array
    low: Array
    high: Array
    label: str
    text: str


def draw(
    results: Mapping[str, Results],
    at: Mapping[str, Value] | None = None,
    region: Region | None = None,
) -> Figure:
    """Draw one map per tuning, with a sentence below each title.

    at: values of the conditions that are not axes of the maps.
    region: a region to outline on every map.
    Raises InputError if a tuning has no cell that the run's criterion and window judge.
    """
    config: AnyConfig = next(iter(results.values())).config
    criterion, window = config.measures.criterion, config.measures.window
    found = {
        tuning: find_winners(config, result.tables["best_scheme"], criterion, window)
        for tuning, result in results.items()
    }
    at = at or {}
    shown = {tuning: select(winners.table, at) for tuning, winners in found.items()}
    for tuning, cells in shown.items():
        if cells.empty:
            raise InputError(
                f"tuning {tuning}: no cell is judged by {criterion} in window {window!r}"
            )
    names = [*scheme_names(config), *list_baselines(config)]
    axes_of_maps = find_world(config).find_conditions(config)[:2]
    planes = {tuning: Plane.of(cells, axes_of_maps) for tuning, cells in shown.items()}
    columns = max(len(plane.columns) for plane in planes.values())
    lines = max(len(plane.lines) for plane in planes.values())
    column, row = float(np.clip(6.0 / columns, *COLUMN)), float(np.clip(5.0 / lines, *ROW))
    width = BESIDE + columns * column
    across = max(width, 4.8) * len(results)
    title = f"Best scheme by {JUDGED[criterion].title}, {style.describe_window(window)}"
    title += f", {find_world(config).describe_values(at)}" if at else ""
    beside = int(12 * (across - LEGEND))  # letters
    texts = [title, *describe_origin(config).splitlines()]
    told = [line for text in texts for line in textwrap.wrap(text, beside)]
    height = 2.1 + LINE * len(told) + lines * row
    room = region is None and row >= ONE_LINE and column >= LETTER * (max(map(len, names)) + 9)
    text = "lines" if room else "best"
    figure = style.new_figure(across, height)
    panels = figure.subplots(1, len(results), squeeze=False)[0]
    for axes, (tuning, cells) in zip(panels, shown.items(), strict=True):
        labels = text if len(cells) <= MOST_LABELS else "none"
        draw_cells(axes, cells.to_dict("records"), names, planes[tuning], labels=labels)
        letters = int(12 * max(width, 4.8))
        sentence = "\n".join(textwrap.wrap(tell_counts(cells), letters))
        if region is not None:
            _outline(axes, planes[tuning], region)
        axes.set_title(f"Tuning {tuning}\n{sentence}", loc="left", fontsize=10)
    named = {str(name) for cells in shown.values() for name in cells["best"]}
    handles = list_shades([name for name in names if name in named], names)
    if region is not None:
        handles.append(Polygon([(0.0, 0.0)], label=region.label, **_OUTLINE))
    figure.legend(
        handles=handles,
        handler_map=HANDLERS,
        loc="outside upper right",
        ncols=2,
        frameon=False,
    )
    figure.suptitle("\n".join(told), x=0.01, ha="left", fontsize=10)
    notes = dict.fromkeys(note for winners in found.values() for note in winners.notes)
    second = [RUNNER_UP] if room else []
    judged = tell_window(window, config.measures.settling_time)
    outlined = [region.text] if region is not None else []
    same = [
        f"Tuning {tuning}: {sentence}"
        for tuning, cells in shown.items()
        for sentence in style.explain_coinciding(_find_groups(results[tuning], cells, second=room))
    ]
    footnotes = [*outlined, *second, EXPLANATION, *same, *notes, judged]
    style.footnote(figure, " ".join(footnotes))
    return figure


def _find_groups(result: Results, cells: pd.DataFrame, *, second: bool) -> list[Sequence[str]]:
    """Find the groups of schemes with equal results that a map names, as runners-up if `second`."""
    if result.rows.empty:
        return []
    config: AnyConfig = result.config
    named = {*cells["best"], *(cells["runner_up"] if second else ())}
    return style.choose_groups(find_alike(config, result.rows), named)


#: Yellow, as the envelope is in the paper. There is no fill: it would change the cells' colours.
_OUTLINE: style.Look = {
    "fill": False, "edgecolor": "#FFDD00", "linewidth": 2.4,
    "path_effects": [Stroke(linewidth=4.8, foreground="black"), Normal()],
}  # fmt: skip


def _outline(axes: Axes, plane: Plane, region: Region) -> None:
    across = plane.column_of(region.natural_period)
    low, high = plane.height_of(region.low), plane.height_of(region.high)
    corners = np.concatenate([np.stack([across, low], 1), np.stack([across, high], 1)[::-1]])
    axes.add_patch(Polygon(corners, zorder=6, **_OUTLINE))


EXPLANATION = (
    f"Colour: the scheme of least error in the cell. {margin.EXPLANATION} Hatched: the records do "
    "not show that the best scheme is better than the next best (95 % over one map). All tunings "
    "have the same records of motion and noise; only what the schemes assume differs."
)
