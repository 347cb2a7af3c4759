"""Draw two tunings side by side: best-scheme maps, and why HME1 and HME2 change places.

    python -m experiments.ren2019.two_maps PAPER_RUN MATCHED_RUN [FILE_STEM]

PAPER_RUN and MATCHED_RUN are the folders of two runs, or twice that of a run of both tunings. The
files are FILE_STEM.png and FILE_STEM.svg (default: two_maps in the current folder).

Each map shows the boundary at which HME1 and HME2 have equal errors. Below each map, a panel shows
each scheme's error from motion against frequency, and the scheme's error from sensor noise. At the
boundary, the sum of these two errors is equal for HME1 and HME2.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any, cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import owtsweep
from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.best_scheme_map import draw_cells
from owtsweep.figures.margin import add_legend, list_shades
from owtsweep.figures.plane import Plane
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.boundary import find_boundary, subtract_schemes
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import scheme_names
from owtsweep.studies.hub.describe import (
    describe_origin,
    find_winners,
    make_cube,
    tell_window,
)
from owtsweep.studies.hub.figures import error_spectra
from owtsweep.studies.hub.measures import CRITERIA
from owtsweep.studies.hub.worlds import BOUNDARY, CONDITIONS
from owtsweep.sweep.runs import Run

LOWER, UPPER = BOUNDARY
CRITERION = "position"
#: Characters of a line above a map.
WIDTH = 70
#: Where a line crosses a cell, the label moves to the left, and up or down, by this part of it.
ASIDE = 0.3


def draw(paper: Run, matched: Run) -> Figure:
    """Draw the best-scheme maps of two runs side by side, and the error spectra below the maps.

    Usually one run has tuning=paper and the other run has tuning=matched.

    Parameters
    ----------
    paper, matched
        Finished runs of the hub study, drawn left and right; the titles name their tunings.

    Raises
    ------
    InputError
        If a run is of another study, has no results, or has no scheme with an error spectrum.
    """
    for argument, run in (("paper", paper), ("matched", matched)):
        if run.study.name != "hub":
            raise InputError(
                f"{argument}: {run.folder} is a run of the study {run.study.name!r}; "
                "use a run of the study hub"
            )
        if "" not in run.config.by_tuning():
            raise InputError(
                f"{argument}: {run.folder} is a run of several tunings; use one of them, e.g. "
                "run.by_tuning()['paper']"
            )
    runs = (paper, matched)
    configs = [cast("HubConfig", run.config) for run in runs]
    errors = [error_spectra.compute(config) for config in configs]
    names = list(dict.fromkeys(name for config in configs for name in scheme_names(config)))
    with style.context():
        figure = style.new_figure(13.0, 11.0)
        panels = figure.subplots(2, 2, height_ratios=[1.15, 1.0])
        notes: list[str] = []
        for run, config, axes in zip(runs, configs, panels[0], strict=True):
            notes += draw_map(axes, run, config)
        for config, spectra, axes in zip(configs, errors, panels[1], strict=True):
            error_spectra.panel(axes, spectra, config, CRITERION)
            notes += error_spectra.unsettled(config, spectra)
            title = "Settled error from a motion of 1 m rms by its frequency, tuning: "
            axes.set_title(f"{title}{config.tuning_name}", loc="left", fontsize=10)
        lows, highs = zip(*(axes.get_ylim() for axes in panels[1]), strict=True)
        for axes in panels[1]:
            axes.set_ylim(min(lows), max(highs))
        handles = list_shades(names, names)
        handles += panels[0, 0].plot([], [], **_LINE, label=f"{LOWER}/{UPPER} boundary")
        add_legend(figure, handles, columns=len(handles))
        style.footnote(figure, " ".join([*notes, *_differences(configs), *_explanations(configs)]))
    return figure


_LINE: dict[str, Any] = {
    "color": "black", "linewidth": 2.0, "marker": "o", "markersize": 5,
    "markeredgecolor": "white", "zorder": 5,
}  # fmt: skip


def draw_map(axes: Axes, run: Run, config: HubConfig) -> list[str]:
    """Draw one run's map with the HME1/HME2 boundary; return the sentences for the footnote.

    Raises
    ------
    InputError
        If the run has no cell that is judged by position.
    """
    window, tuning = config.measures.window, config.tuning_name
    shown, names, notes = find_winners(config, run.best_scheme(), CRITERION, window)
    if shown.empty:
        raise InputError(
            f"criterion: the run {run.folder} has no {CRITERION} MSE in the window {window!r}; "
            "use a run with results"
        )
    plane, rows = Plane.of(shown, CONDITIONS), run.cases()
    boundaries = _find_boundaries(rows, window)
    crossing = None if boundaries is None else _place_boundary(boundaries, plane)
    draw_cells(axes, shown.to_dict("records"), names, plane, labels="best")
    lines = [
        f"Best scheme by {CRITERION} MSE, tuning: {config.tuning_name}",
        style.describe_window(window),
        *wrap(describe_origin(config), WIDTH),
    ]
    axes.set_title("\n".join(lines), loc="left", fontsize=10)
    same = style.choose_groups(
        find_coinciding(make_cube(config, rows), CRITERIA), set(shown["best"])
    )
    notes = [f"{tuning}: {note}" for note in notes]
    notes += [f"{tuning}: {' and '.join(group)} coincide, shown as {group[-1]}." for group in same]
    if boundaries is None or crossing is None:
        return [*notes, f"{tuning}: no boundary, since the run lacks superposed rows of it."]
    make_way(axes, crossing)
    _draw_boundary(axes, crossing)
    return notes + _explain_absence(boundaries, tuning)


def _find_boundaries(rows: pd.DataFrame, window: str) -> pd.DataFrame | None:
    """Find the boundary; None if a scheme is not in the run, or amplitudes were run one by one."""
    try:
        difference = subtract_schemes(rows, CONDITIONS, BOUNDARY, CRITERION, window)
    except InputError:
        return None
    return find_boundary(difference, BOUNDARY)


@dataclass(frozen=True)
class Crossing:
    """A line across a map, with a vertical bar in the middle of each column that it passes.

    `columns`: the columns with a point of the line, increasing, shape (n,). `heights`, `low`,
    `high`: the line there, and the ends of its bars, shape (n,) each, in the coordinates of a
    `Plane`.
    """

    columns: Array
    heights: Array
    low: Array
    high: Array

    def height_at(self, column: float) -> float:
        """Return the height of the line at a place between two columns; NaN if it has no point."""
        return float(np.interp(column, self.columns, self.heights)) if len(self.columns) else np.nan

    def meets(self, column: int, line: int) -> bool:
        """Return whether the line or its bar passes through the left or the middle of a cell."""
        middle = self.columns == column
        bar = (self.low[middle] < line + 0.5) & (self.high[middle] > line - 0.5)
        heights = [self.height_at(column - ASIDE), self.height_at(column)]
        return bool(bar.any()) or any(abs(height - line) < 0.5 for height in heights)


def make_way(axes: Axes, line: Crossing) -> None:
    """Move the names of schemes on a map aside where they are in the way of a line across it."""
    for name in axes.texts:
        column, row = map(round, name.get_position())
        if line.meets(column, row):
            # The bars are in the middle of the column, so they end at the name's right.
            height = line.height_at(column - ASIDE) - row
            up_or_down = 0.0 if abs(height) > 0.5 else -ASIDE if height > 0.0 else ASIDE
            name.set(x=column - 0.46, y=row + up_or_down, ha="left")


def _place_boundary(boundaries: pd.DataFrame, plane: Plane) -> Crossing:
    """Return the boundary and its 95 % intervals in the coordinates of the map."""
    exists = boundaries[boundaries["wins"] == ""]
    columns = [plane.columns.index(period) for period in exists["natural_period"]]
    return Crossing(
        np.array(columns, dtype=float),
        *(
            plane.height_of(exists[name].to_numpy(dtype=float))
            for name in ("boundary", "ci_low", "ci_high")
        ),
    )


def _draw_boundary(axes: Axes, boundary: Crossing) -> None:
    column, middle = boundary.columns, boundary.heights
    outline: dict[str, Any] = {"color": "white", "solid_capstyle": "butt", "zorder": 4}
    axes.plot(column, middle, linewidth=5.0, **outline)
    axes.plot(column, middle, **_LINE)
    finite = np.isfinite(boundary.low) & np.isfinite(boundary.high)
    ends = column[finite], boundary.low[finite], boundary.high[finite]
    for width, color in ((5.0, "white"), (1.6, "black")):
        axes.vlines(*ends, color=color, linewidth=width, zorder=4.5)


def _explain_absence(boundaries: pd.DataFrame, tuning: str) -> list[str]:
    """Write a sentence on the periods without a boundary, for each reason."""
    notes = []
    for winner in sorted(set(boundaries["wins"]) - {""}):
        without = boundaries["natural_period"][boundaries["wins"] == winner]
        listed = ", ".join(f"{T:g}" for T in without)
        outcome = (
            f"of the two {winner} is better at every amplitude."
            if winner in (LOWER, UPPER)
            else f"{LOWER} and {UPPER} do not change places once."
        )
        notes.append(f"{tuning}, {listed} s: no boundary; {outcome}")
    return notes


def _differences(configs: Sequence[HubConfig]) -> list[str]:
    """Return, in a list, a sentence that names the settings in which two runs differ.

    The tuning is not named. The list is empty if no other setting differs.
    """
    one, other = configs
    keys = ("seed", "record", "spectrum", "normalise", "band", "wave_direction", "sensors", "grid")
    changed = [key for key in (*keys, "measures") if getattr(one, key) != getattr(other, key)]
    if not changed:
        return []
    return [f"The two runs differ not only in their tuning: {', '.join(changed)}."]


def _explanations(configs: Sequence[HubConfig]) -> list[str]:
    scale = ""
    if all(config.normalise == "peak" for config in configs):
        scale = "; there the amplitude is the largest displacement, some 3 to 4 times the rms"
    return [
        f"Boundary: amplitude at which the mean MSE of {LOWER} and {UPPER} is equal, with its 95 %"
        " interval (bootstrap over the records); between two rows it is placed logarithmically.",
        "Hatched: best and runner-up cannot be told apart.",
        error_spectra.EXPLANATION,
        "So a boundary in the maps is where the square of the amplitude times the difference of two"
        f" curves makes up for the difference of their bars{scale}.",
        *dict.fromkeys(
            tell_window(config.measures.window, config.measures.settling_time) for config in configs
        ),
    ]


def save(paper: Run, matched: Run, stem: Path) -> list[Path]:
    """Draw two runs side by side into `stem`.png and `stem`.svg; return the files."""
    metadata = {"paper": paper.hash, "matched": matched.hash}
    return style.save(draw(paper, matched), stem.parent, stem.name, metadata)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit("usage: python -m experiments.ren2019.two_maps PAPER_RUN MATCHED_RUN [FILE_STEM]")
    runs = [owtsweep.load(path) for path in sys.argv[1:3]]
    one, other = (
        run.by_tuning().get(tuning, run)
        for run, tuning in zip(runs, ("paper", "matched"), strict=True)
    )
    for file in save(one, other, Path(sys.argv[3] if len(sys.argv) == 4 else "two_maps")):
        print(file)
