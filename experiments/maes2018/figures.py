"""Figures 9 to 13 of Maes et al. (2018) in our truth, and a picture of the blade itself.

    python -m experiments.maes2018.figures [FOLDER] [FIGURE ...]

FOLDER (default: results/blade_paper) gets a PNG and an SVG of each FIGURE (default: of all), of one
record. FIGURE is figure_9 to figure_13, or blade.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from experiments.command import draw_named
from experiments.maes2018.picture import draw_picture
from experiments.maes2018.processing import COLUMNS, Motions, process
from experiments.maes2018.scenarios import REFERENCE, make_record
from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import RATE as BOOM_RATE
from owtsweep.figures import style
from owtsweep.figures.drawings import save_figure
from owtsweep.studies.blade.boom import estimate_boom

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: What is wrong with the total stations in the figures, and the scheme of the paper's system.
SCENARIO, SCHEME = "late clock", "UKF"
#: Part of the record that is shown, s.
VIEW = (60.0, 180.0)
#: As in the paper: red the total stations, blue and dashed the inertial system.
STATIONS: dict[str, Any] = {"color": "#CC3311", "linewidth": 1.3, "label": "total stations"}
INERTIAL: dict[str, Any] = {
    "color": "#0044AA", "linewidth": 1.1, "linestyle": (0, (4, 2)),
    "label": "GNSS and inertial unit",
}  # fmt: skip
#: Order of translations in the figures, and of the boom's directions.
ORDER = {"lateral": 1, "longitudinal": 0, "vertical": 2}


class Shown(NamedTuple):
    """What the figures show: both systems, the boom's tip in m at 20 Hz (n, 3), and where from."""

    motions: Motions
    boom: Array
    origin: str


def draw_figures(names: Sequence[str], folder: Path, replicate: int = 0) -> list[Path]:
    """Draw figures by name into a folder as PNG and SVG; return the files.

    `replicate` is the number of the record.
    """
    record = make_record(REFERENCE[SCENARIO], replicate)
    assert record.measured.boom is not None
    origin = (
        "Truth: rigid blade on a hook, fog grade, GNSS 6 mm at 5 Hz, total stations 3 mm at about "
        f"1 Hz; their clock is .1 s late; {SCHEME}, tuning matched; record {replicate}, seed "
        f"{record.config.seed}."
    )
    shown = Shown(
        process(record.truth, record.run(SCHEME), record.measured),
        estimate_boom(record.measured.boom),
        origin,
    )
    files: list[Path] = []
    for name in names:
        files += save_figure(partial(FIGURES[name], shown), {})(folder, name)
    return files


def _draw_translations(shown: Shown, *, differences: bool) -> Figure:
    """Draw translations of root and centre of gravity, or their differences (Figs. 9 and 11)."""
    figure = style.new_figure(11.0, 5.4)
    panels = figure.subplots(2, 3, sharex=True)
    for row, (point, words) in enumerate((("root", "root"), ("cog", "COG"))):
        for axes, (name, axis) in zip(panels[row], ORDER.items(), strict=True):
            column = COLUMNS.index(f"{point}_{'uvw'[axis]}")
            _draw(axes, shown.motions, column, 1e3, differences=differences)
            axes.set_title(f"{words}, {name}", fontsize=9)
    for axes in panels[:, 0]:
        axes.set_ylabel("difference (mm)" if differences else "displacement (mm)")
    for axes in panels[1]:
        axes.set_xlabel("time (s)")
    return _finish(figure, panels[0][0], shown, "11" if differences else "9")


def _draw_rotations(shown: Shown, *, differences: bool) -> Figure:
    """Draw heading, pitch and roll, or differences of both systems (Figs. 10 and 12)."""
    figure = style.new_figure(11.0, 3.4)
    panels = figure.subplots(1, 3, sharex=True)
    for axes, name in zip(panels, ("heading", "pitch", "roll"), strict=True):
        _draw(axes, shown.motions, COLUMNS.index(name), 180.0 / np.pi, differences=differences)
        axes.set_title(name, fontsize=9)
        axes.set_xlabel("time (s)")
    panels[0].set_ylabel("difference (deg)" if differences else "angle (deg)")
    return _finish(figure, panels[0], shown, "12" if differences else "10")


def _draw_boom(shown: Shown) -> Figure:
    """Draw the displacements of the boom's tip above .15 Hz (Fig. 13)."""
    figure = style.new_figure(11.0, 3.4)
    panels = figure.subplots(1, 3, sharex=True, sharey=True)
    time = np.arange(len(shown.boom)) / BOOM_RATE
    part = (time >= VIEW[0]) & (time <= VIEW[1])
    for axes, (name, axis) in zip(panels, ORDER.items(), strict=True):
        axes.plot(time[part], 1e3 * shown.boom[part, axis], color="#0044AA", linewidth=0.8)
        axes.set_title(f"boom's tip, {name}", fontsize=9)
        axes.set_xlabel("time (s)")
    panels[0].set_ylabel("above .15 Hz (mm)")
    return _finish(figure, panels[0], shown, "13")


def _draw(axes: Axes, motions: Motions, column: int, factor: float, *, differences: bool) -> None:
    """Draw one column of both systems about their common mean, or their difference."""
    part = (motions.time >= VIEW[0]) & (motions.time <= VIEW[1])
    time = motions.time[part]
    first, second = motions.stations[part, column], motions.inertial[part, column]
    if differences:
        off = factor * (second - first)
        axes.plot(time, off, color="0.2", linewidth=0.8)
        axes.axhline(0.0, color="0.6", linewidth=0.6)
        axes.text(
            0.98, 0.95, f"rms {np.sqrt(np.mean(off**2)):.2g}", transform=axes.transAxes,
            ha="right", va="top", fontsize=8,
        )  # fmt: skip
        return
    middle = first.mean()
    axes.plot(time, factor * (first - middle), **STATIONS)
    axes.plot(time, factor * (second - middle), **INERTIAL)


def _finish(figure: Figure, axes: Axes, shown: Shown, number: str) -> Figure:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right", framealpha=0.9, fontsize=7)
    told = f"As Fig. {number} of Maes et al. (2018), in our truth."
    style.add_origin(figure, f"{told}\n{shown.origin}")
    return figure


#: Name of a figure -> function that draws it.
FIGURES: dict[str, Callable[[Shown], Figure]] = {
    "figure_9": partial(_draw_translations, differences=False),
    "figure_10": partial(_draw_rotations, differences=False),
    "figure_11": partial(_draw_translations, differences=True),
    "figure_12": partial(_draw_rotations, differences=True),
    "figure_13": _draw_boom,
}


def draw_chosen(names: Sequence[str], folder: Path) -> list[Path]:
    """Draw figures by name, with the picture of the blade among them."""
    files = draw_figures([name for name in names if name in FIGURES], folder)
    return [*files, *draw_picture(folder)] if "blade" in names else files


if __name__ == "__main__":
    draw_named("results/blade_paper", [*FIGURES, "blade"], draw_chosen)
