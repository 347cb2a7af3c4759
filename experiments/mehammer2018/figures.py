"""Figures 3 to 8 of Mehammer et al. (2018), drawn of one record of the study's truth.

    python -m experiments.mehammer2018.figures [FOLDER] [FIGURE ...]

FOLDER (default: results/floater_paper) gets a PNG and an SVG of each FIGURE (default: of all), of
one record. FIGURE is figure_3 to figure_8.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.command import draw_named, read_data
from experiments.mehammer2018.scenarios import PAPER, Outcome, run_scenario
from experiments.mehammer2018.scores import X, find_relative
from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.drawings import save_figure
from owtsweep.figures.lines import clip, make_line
from owtsweep.studies.floater.schemes import SCHEMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TRUTH: dict[str, Any] = {"color": "black", "linewidth": 1.8, "label": "truth", "zorder": 2.2}
MEASURED: dict[str, Any] = {"color": "0.7", "linewidth": 0.6, "label": "measured", "zorder": 2.0}
#: Smallest relative error on an axis, %.
FLOOR = 1e-4
Outcomes = Mapping[str, Outcome]


def draw_surge(outcomes: Outcomes, title: str, limit: float, view: tuple[float, float]) -> Figure:
    """Draw surge and its relative error (figures 3 to 7).

    Parameters
    ----------
    outcomes
        Of scenarios with the same measurements.
    title
        What the figure shows, and its number in the paper.
    limit
        What the paper says of the relative error, %.
    view
        Begin and end of an excerpt in s.
    """
    figure = style.new_figure(10.0, 6.6)
    above, close, below = figure.subplots(3, 1, height_ratios=(1.0, 1.0, 1.1))
    first = next(iter(outcomes.values()))
    time = first.time
    for axes, span in ((above, (0.0, float(time[-1]))), (close, view)):
        _draw_line(axes, time, first.measured.position[:, X], span, MEASURED)
        _draw_line(axes, time, first.truth.position[:, X], span, TRUTH)
        for outcome in outcomes.values():
            _draw_line(axes, time, outcome.estimates.position[:, X], span, _look(outcome))
        axes.set_xlim(*span)
        axes.set_ylabel("surge (m)")
    for outcome in outcomes.values():
        relative = np.maximum(find_relative(outcome), FLOOR)
        _draw_line(below, time, relative, (0.0, float(time[-1])), _look(outcome))
    below.axhline(limit, color="0.3", linewidth=0.9, linestyle=(0, (4, 3)))
    below.text(
        time[-1], limit, f"paper: {limit:g} %", va="bottom", ha="right", fontsize=8,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
    )  # fmt: skip
    _shade_crossings(below, first)
    below.set_yscale("log")
    below.set_xlim(0.0, float(time[-1]))
    below.set_ylim(FLOOR, None)
    below.set_ylabel("|error| / |surge| (%)")
    below.set_xlabel("time (s); grey: surge below a tenth of its standard deviation")
    _finish(figure, above, title, outcomes)
    return figure


def draw_velocity(outcomes: Outcomes, title: str, view: tuple[float, float]) -> Figure:
    """Draw the velocity of surge, whole and in an excerpt (figure 8)."""
    figure = style.new_figure(10.0, 5.6)
    grid = figure.subplots(2, 1)
    first = next(iter(outcomes.values()))
    for axes, span in zip(grid, ((0.0, float(first.time[-1])), view), strict=True):
        for outcome in outcomes.values():
            _draw_line(axes, outcome.time, outcome.estimates.velocity[:, X], span, _look(outcome))
        _draw_line(axes, first.time, first.truth.velocity[:, X], span, TRUTH)
        axes.set_xlim(*span)
        axes.set_ylabel("velocity of surge (m/s)")
    grid[1].set_xlabel("time (s)")
    _finish(figure, grid[0], title, outcomes)
    return figure


def _look(outcome: Outcome) -> dict[str, Any]:
    look = SCHEMES.listed[outcome.scheme].look
    label = style.label_of(outcome.scheme)
    return {
        "color": look.color, "linestyle": look.line, "linewidth": 1.1, "label": label,
        "zorder": 2.3,
    }  # fmt: skip


def _draw_line(
    axes: Axes, time: Array, values: Array, span: tuple[float, float], look: dict[str, Any]
) -> None:
    pieces = make_line(*clip(time, values, span))
    for number, piece in enumerate(pieces):
        axes.plot(*piece, **(look if number == 0 else {**look, "label": "_"}))


def _shade_crossings(axes: Axes, outcome: Outcome) -> None:
    x = outcome.truth.position[:, X]
    near = np.abs(x) < 0.1 * x.std()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], near.astype(int), [0]])))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        span = outcome.time[[begin, end - 1]]
        axes.axvspan(*span, color="0.9", zorder=0)


def _finish(figure: Figure, axes: Axes, title: str, outcomes: Outcomes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    style.add_legend_above(figure, handles, title, len(labels))
    for text, label in zip(figure.legends[0].get_texts(), labels, strict=True):
        text.set_text(label)
    first = next(iter(outcomes.values()))
    config = first.config
    moved = "decay of a buoy" if config.motion.kind == "decay" else "synthetic floater"
    if first.scenario.printed:
        moved += ", accelerations exact and held, estimates begin at the truth"
    style.footnote(
        figure,
        f"Truth: {moved}, {config.record.rate:g} Hz, not the author's record; tuning "
        f"{first.scenario.tuning}; seed {config.seed}, record 0. Shown: {'; '.join(outcomes)}.",
    )


#: Figure -> what it shows, as figures.toml says.
FIGURES = read_data(__file__)


def draw_figures(
    names: Sequence[str], folder: Path, overrides: Sequence[str] = (), replicate: int = 0
) -> list[Path]:
    """Run one record of what figures need, and draw them as PNG and SVG; return the files.

    Parameters
    ----------
    names
        Keys of `FIGURES`.
    folder
        Made if it does not exist.
    overrides
        Overrides of the configuration, e.g. "seed=1".
    replicate
        Number of the record.
    """
    files = []
    for number in names:
        figure = dict(FIGURES[number])
        needed = figure.pop("shown")
        run = {name: run_scenario(PAPER[name], replicate, overrides) for name in dict(needed)}
        outcomes = {f"{name}, {scheme}": run[name][scheme] for name, scheme in needed}
        draw = draw_surge if "limit" in figure else draw_velocity
        files += save_figure(partial(draw, outcomes, **figure), None)(folder, number)
    return files


if __name__ == "__main__":
    draw_named("results/floater_paper", FIGURES, draw_figures)
