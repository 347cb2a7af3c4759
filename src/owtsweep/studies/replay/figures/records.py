"""Draw the best scheme of many records as a map over two properties of the records."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from owtsweep.errors import InputError
from owtsweep.figures import margin, style
from owtsweep.figures.best_scheme_map import HATCH, HATCH_OPACITY
from owtsweep.figures.margin import add_legend, list_shades
from owtsweep.figures.palette import style_of, text_color_on
from owtsweep.studies.hub.public import BASELINES, tell_window
from owtsweep.studies.replay.advice import LEAST_MARGIN
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.seastates import find_axes, read_sea_states

#: If a column of the table has at most this many different values, they are the ticks of the axis.
MOST_TICKS = 12


def draw(config: ReplayConfig, records: pd.DataFrame, advised: pd.DataFrame) -> Figure:
    """Draw one mark per record, which names the best scheme, the runner-up and the margin.

    A mark is hatched if the margin does not matter. Axes are the first two columns of numbers in
    `replay.table`; the largest displacement (m) and the fitted period (s) stand for missing ones.
    Raises InputError if no record has values on both axes.
    """
    table, (first, second) = _choose_coordinates(config, records)
    measured = advised[(advised["source"] != "map") & (advised["noise"] != "estimated")]
    shown = table.merge(measured, on="file").dropna(subset=[first, second])
    if shown.empty:
        raise InputError(
            "no record has values on both axes of the map; give replay.table=FILE.csv with two "
            "columns of numbers"
        )
    names = sorted(set(shown["best"]) | set(shown["runner_up"].dropna()) - {""})
    figure = style.new_figure(8.0, 6.0)
    axes = figure.add_subplot()
    width, height = _measure_cell(shown[first]), _measure_cell(shown[second])
    for line in shown.to_dict("records"):
        fill = margin.fill_cell(style_of(line["best"], names), 1.0 + line["margin"])
        _mark(axes, (line[first], line[second]), (width, height), fill, line)
    axes.set_xlim(shown[first].min() - width, shown[first].max() + width)
    axes.set_ylim(shown[second].min() - height, shown[second].max() + height)
    if config.replay.table is not None:  # the values of the table as ticks, if there are few
        for axis, name in ((axes.xaxis, first), (axes.yaxis, second)):
            if shown[name].nunique() <= MOST_TICKS:
                axis.set_ticks(sorted(shown[name].unique()))
    axes.set(xlabel=_LABELS.get(first, first), ylabel=_LABELS.get(second, second))
    axes.grid(visible=False)
    window = style.describe_window(config.measures.window)
    axes.set_title(
        f"Best scheme by {config.measures.criterion} MSE, {len(shown)} records\n"
        f"{window}, tuning: {config.tuning}",
        loc="left",
    )
    handles = list_shades(sorted(set(shown["best"])), names)
    hatched = Patch(facecolor="0.9", edgecolor="0.5", hatch=HATCH, label="does not matter")
    handles += [] if all(shown["matters"]) else [hatched]
    add_legend(figure, handles, columns=len(handles))
    settling = config.measures.settling_time
    judged = dict.fromkeys(tell_window(name, settling) for name in shown["window"])
    style.footnote(
        figure,
        f"Second line: the runner-up, and by how much its MSE is larger."
        f" Hatched: it is larger by less than {100.0 * LEAST_MARGIN:g} %, or the paired"
        " interval (95 %) of the difference holds zero."
        " NONE!, HOLD!, DELTA!: no scheme is better than this baseline."
        f" {' '.join(judged)}",
    )
    return figure


#: Column of the map -> label of its axis. Other columns of a user's table keep their names.
_LABELS = {
    "natural_period": "fitted natural period (s)",
    "peak": "amplitude: largest displacement (m)",
    "Hs": "significant wave height Hs (m)",
    "Tp": "peak period of the waves Tp (s)",
}


def _choose_coordinates(
    config: ReplayConfig, records: pd.DataFrame
) -> tuple[pd.DataFrame, tuple[str, str]]:
    states = read_sea_states(config)
    if states is not None:
        names = find_axes(states)
        if len(names) >= 2:
            return states, (names[0], names[1])
        return records, (names[0], "peak")
    if "natural_period" not in records:
        raise InputError(
            "no record has a fitted natural period, an axis of the map; give replay.table=FILE.csv"
        )
    return records, ("natural_period", "peak")


def _measure_cell(values: pd.Series[float]) -> float:
    """Return the width of the marks along one axis of the map, for the records' values on it."""
    coordinates = np.unique(values)
    if len(coordinates) < 2:
        return max(abs(float(coordinates[0])) * 0.2, 1e-3)
    return float(max(np.diff(coordinates).min(), np.ptp(coordinates) / 12.0))


def _name_schemes(line: Mapping[Hashable, Any]) -> str:
    best, excess, recommended = line["best"], line["margin"], line["recommended"]
    text = best if np.isnan(excess) else f"{best}\n{line['runner_up']} +{100.0 * excess:.0f} %"
    return f"{recommended}!\n{text}" if recommended in BASELINES and recommended != best else text


def _mark(
    axes: Axes,
    place: tuple[float, float],
    size: tuple[float, float],
    fill: str,
    line: Mapping[Hashable, Any],
) -> None:
    color = text_color_on(fill)
    corner = (place[0] - size[0] / 2.0, place[1] - size[1] / 2.0)
    axes.add_patch(Rectangle(corner, *size, facecolor=fill, edgecolor="white"))
    box = None
    if not line["matters"]:
        edge = to_rgba(color, HATCH_OPACITY)
        axes.add_patch(Rectangle(corner, *size, facecolor="none", edgecolor=edge, hatch=HATCH))
        box = {"facecolor": fill, "edgecolor": "none", "pad": 1.0}
    text = _name_schemes(line)
    axes.text(*place, text, ha="center", va="center", color=color, fontsize=9, bbox=box)
