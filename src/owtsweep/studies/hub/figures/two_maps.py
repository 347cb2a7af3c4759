"""Draw two tunings side by side: best-scheme maps, the HME1/HME2 boundary, and its cause.

Below each map, a panel shows each scheme's error from motion against frequency, and its noise
floor. At the boundary, HME1 and HME2 have equal sums of these two parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.best_scheme_map import draw_cells
from owtsweep.figures.palette import style_of
from owtsweep.figures.plane import Plane
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.boundary import find_boundary
from owtsweep.studies.hub import scheme_names
from owtsweep.studies.hub.conditions import BOUNDARY, CONDITIONS, CRITERIA, make_cube
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.figures import error_spectra
from owtsweep.studies.hub.winners import find_winners

if TYPE_CHECKING:
    from owtsweep.sweep.runs import Run

LOWER, UPPER = BOUNDARY


def draw(paper: Run, matched: Run, *, criterion: str = "position") -> Figure:
    """Draw the maps of two runs, usually tuning=paper and tuning=matched, and their error spectra.

    Parameters
    ----------
    paper, matched
        Finished runs of the hub study, drawn left and right; the titles name their tunings.
    criterion
        The measure by which the schemes are compared, "position" or "velocity".

    Raises
    ------
    InputError
        If a run is of another study or has no results for the criterion, or if the criterion is
        neither "position" nor "velocity".
    """
    if criterion not in error_spectra.UNITS:
        usable = " or ".join(error_spectra.UNITS)
        raise InputError(f"criterion: {criterion!r} has no error spectrum; use {usable}")
    for argument, run in (("paper", paper), ("matched", matched)):
        if run.study.name != "hub":
            raise InputError(
                f"{argument}: {run.folder} is a run of the study {run.study.name!r}; use one of hub"
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
            notes += _map(axes, run, config, criterion)
        for config, spectra, axes in zip(configs, errors, panels[1], strict=True):
            error_spectra.panel(axes, spectra, config, criterion)
            notes += error_spectra.unsettled(config, spectra)
            title = "Settled error from a motion of 1 m rms by its frequency, tuning: "
            axes.set_title(f"{title}{config.tuning}", loc="left", fontsize=10)
        lows, highs = zip(*(axes.get_ylim() for axes in panels[1]), strict=True)
        for axes in panels[1]:
            axes.set_ylim(min(lows), max(highs))
        handles: list[Any] = [
            Patch(facecolor=style_of(name, names).color, label=style.label_of(name))
            for name in names
        ]
        handles += panels[0, 0].plot([], [], **_LINE, label=f"{LOWER}/{UPPER} boundary")
        columns = len(handles)
        figure.legend(handles=handles, loc="outside upper center", ncols=columns, frameon=False)
        style.footnote(figure, " ".join([*notes, *_differences(configs), *_explanations(configs)]))
    return figure


_LINE: dict[str, Any] = {
    "color": "black", "linewidth": 2.0, "marker": "o", "markersize": 5,
    "markeredgecolor": "white", "zorder": 5,
}  # fmt: skip


def _map(axes: Axes, run: Run, config: HubConfig, criterion: str) -> list[str]:
    """Draw one run's map with the boundary; return the sentences for the footnote."""
    window = config.measures.window
    best, names, notes = find_winners(config, run.best_scheme(), criterion)
    shown = best[best["window"] == window]
    if shown.empty:
        raise InputError(f"criterion: {run.folder} has no cell judged by {criterion} MSE")
    plane = Plane.of(shown, CONDITIONS)
    draw_cells(axes, shown.to_dict("records"), names, plane, labels="best")
    records = config.grid.replicates
    axes.set_title(
        f"Best scheme by {criterion} MSE, tuning: {config.tuning}\n"
        f"{style.describe_window(window)}, {records} record{'s' * (records != 1)} per cell",
        loc="left",
        fontsize=10,
    )
    rows = run.cases()
    same = find_coinciding(make_cube(config, rows), CRITERIA)
    notes = [f"{config.tuning}: {note}" for note in notes]
    notes += [
        f"{config.tuning}: {' and '.join(group)} coincide, shown as {group[-1]}." for group in same
    ]
    try:
        boundaries = find_boundary(rows, CONDITIONS, BOUNDARY, criterion, window)
    except InputError:  # a scheme is not in this run, or amplitudes were run one by one
        return [*notes, f"{config.tuning}: no boundary, since the run lacks superposed rows of it."]
    return notes + _boundary(axes, boundaries, plane, config.tuning)


def _boundary(axes: Axes, boundaries: pd.DataFrame, plane: Plane, tuning: str) -> list[str]:
    exists = boundaries[boundaries["wins"] == ""]
    if not exists.empty:
        column = [plane.columns.index(period) for period in exists["natural_period"]]
        middle, low, high = (
            plane.height_of(exists[name].to_numpy(dtype=float))
            for name in ("boundary", "ci_low", "ci_high")
        )
        outline: dict[str, Any] = {"color": "white", "solid_capstyle": "butt", "zorder": 4}
        axes.plot(column, middle, linewidth=5.0, **outline)
        axes.plot(column, middle, **_LINE)
        finite = np.isfinite(low) & np.isfinite(high)
        for width, color in ((5.0, "white"), (1.6, "black")):
            axes.vlines(np.array(column)[finite], low[finite], high[finite], color=color,
                        linewidth=width, zorder=4.5)  # fmt: skip
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
    """Name the keys, besides the tuning, in which the two runs differ, as footnote sentences."""
    one, other = configs
    keys = ("seed", "record", "spectrum", "normalise", "band", "wave_direction", "sensors", "grid")
    changed = [key for key in (*keys, "measures") if getattr(one, key) != getattr(other, key)]
    if not changed:
        return []
    return [f"The two runs differ not only in their tuning: {', '.join(changed)}."]


def _explanations(configs: Sequence[HubConfig]) -> list[str]:
    scale = transient = ""
    if all(config.normalise == "peak" for config in configs):
        scale = "; there the amplitude is the largest displacement, some 3 to 4 times the rms"
    if all(config.measures.window == "full" for config in configs):
        transient = " The maps judge the full record, with its transient."
    return [
        f"Boundary: amplitude at which the mean MSE of {LOWER} and {UPPER} is equal, with its 95 %"
        " interval (bootstrap over the records); between two rows it is placed logarithmically.",
        "Hatched: best and next best cannot be told apart.",
        error_spectra.EXPLANATION,
        "So a boundary in the maps is where the square of the amplitude times the difference of two"
        f" curves makes up for the difference of their bars{scale}.{transient}",
    ]
