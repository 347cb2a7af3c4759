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
from experiments.maes2018.processing import COLUMNS, Motions, process
from experiments.maes2018.scenarios import REFERENCE, make_record
from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import RATE as BOOM_RATE
from owtsweep.figures import style
from owtsweep.figures.drawings import save_figure
from owtsweep.studies.blade.boom import estimate_boom
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, ROOT, UNIT, Truth

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
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

#: Where the drawn blade ends; the paper does not say where its tip is, m.
END = 35.0
#: Points whose tracks are drawn, in the body's frame, m.
TRACKED = np.array([ROOT, [0.0, 0.0, 0.0], PRISMS[2]])
NAMES = ("root", "centre of gravity", "third prism")
#: By how much motions are enlarged beside the blade; part of the record that is drawn, s.
ENLARGED, TRACK = 5.0, (60.0, 100.0)


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


def draw_picture(folder: Path, replicate: int = 0) -> list[Path]:
    """Draw the picture into a folder as PNG and SVG; return the files."""
    record = make_record((), replicate)
    origin = (
        f"Truth: rigid blade on a hook, {TRACK[0]:g} to {TRACK[1]:g} s of record {replicate}, seed "
        f"{record.config.seed}. Tracks of points are {ENLARGED:g} times as large as the motion; "
        "the shape of the blade is drawn freely."
    )
    return save_figure(partial(_draw_tracks, record.truth, origin), {})(folder, "blade")


def _draw_tracks(truth: Truth, origin: str) -> Figure:
    figure = style.new_figure(11.0, 7.2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.25, 1.0))
    first, last = (round(second / truth.step) for second in TRACK)
    part = slice(first, last, 5)
    time = truth.step * np.arange(len(truth.root))[part]
    moved = truth.root[part, None] + np.einsum("nij,kj->nki", truth.rotation[part], TRACKED - ROOT)
    shading: PathCollection | None = None
    tracks = TRACKED + ENLARGED * (moved - TRACKED)
    for axes, axis, words in ((above, 2, "height z (m)"), (below, 1, "lateral y (m)")):
        _draw_blade(axes, axis)
        for k in range(len(TRACKED)):
            shading = axes.scatter(
                tracks[:, k, 0], tracks[:, k, axis], c=time, s=4.0, cmap="viridis", zorder=4
            )
        _mark(axes, axis)
        axes.set_ylabel(words)
        axes.set_aspect("equal")
        axes.grid(visible=False)
    above.set_ylim(-6.0, 13.0)
    below.set_ylim(-7.0, 7.0)
    above.set_title("from the side", fontsize=9, loc="left")
    below.set_title("from above", fontsize=9, loc="left")
    below.set_xlabel("along the blade, x (m)")
    above.plot([0.0, 0.0], [2.0, 12.0], color="0.3", linewidth=1.2)
    above.plot([0.0], [12.0], marker="v", color="0.3", markersize=9)
    above.annotate("hook", (0.0, 12.0), (1.0, 11.2), fontsize=8)
    assert shading is not None
    figure.colorbar(shading, ax=[above, below], label="time (s)", shrink=0.6)
    above.legend(loc="upper right", frameon=False, fontsize=8)
    style.add_origin(figure, origin)
    return figure


def _draw_blade(axes: Axes, axis: int) -> None:
    """Draw the outline: thick at the root, widest a sixth along, thin at the end."""
    x = np.linspace(ROOT[0], END, 60)
    along = (x - ROOT[0]) / (END - ROOT[0])
    half = np.interp(along, [0.0, 0.05, 0.2, 1.0], [1.0, 1.0, 1.6 if axis == 1 else 1.2, 0.15])
    axes.fill_between(x, -half, half, color="0.88", edgecolor="0.6", linewidth=0.8, zorder=1)


def _mark(axes: Axes, axis: int) -> None:
    """Mark the sensors and the names of the tracked points."""
    for points, marker, color, label in (
        (UNIT[None], "s", "#CC3311", "inertial unit"),
        (ANTENNAS, "^", "#0044AA", "GNSS antennas (2 and 3 at prisms)"),
        (PRISMS, "o", "#117733", "prisms of total stations"),
    ):
        axes.plot(
            points[:, 0], points[:, axis], linestyle="", marker=marker, markersize=6,
            markerfacecolor="none", markeredgecolor=color, markeredgewidth=1.4, label=label,
            zorder=5,
        )  # fmt: skip
    if axis == 1:
        return
    for point, name in zip(TRACKED, NAMES, strict=True):
        _name(axes, point, name)


def _name(axes: Axes, point: Array, name: str) -> None:
    axes.annotate(
        name, (point[0], point[2] - 1.4), (point[0], -5.0), fontsize=8, ha="center",
        arrowprops={"arrowstyle": "-", "color": "0.5", "linewidth": 0.7},
    )  # fmt: skip


def draw_chosen(names: Sequence[str], folder: Path) -> list[Path]:
    """Draw figures by name, with the picture of the blade among them."""
    files = draw_figures([name for name in names if name in FIGURES], folder)
    return [*files, *draw_picture(folder)] if "blade" in names else files


if __name__ == "__main__":
    draw_named("results/blade_paper", [*FIGURES, "blade"], draw_chosen)
