"""Draws the blade on its hook from the side and from above, and how its points move over time."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from experiments.maes2018.scenarios import make_record
from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.drawings import save_figure
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, ROOT, UNIT, Truth

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
    from matplotlib.figure import Figure

#: Where the drawn blade ends; the paper does not say where its tip is, m.
END = 35.0
#: Points whose tracks are drawn, in the body's frame, m.
TRACKED = np.array([ROOT, [0.0, 0.0, 0.0], PRISMS[2]])
NAMES = ("root", "centre of gravity", "third prism")
#: By how much motions are enlarged beside the blade; part of the record that is drawn, s.
ENLARGED, VIEW = 5.0, (60.0, 100.0)


def draw_picture(folder: Path, replicate: int = 0) -> list[Path]:
    """Draw the picture into a folder as PNG and SVG; return the files."""
    record = make_record((), replicate)
    origin = (
        f"Truth: rigid blade on a hook, {VIEW[0]:g} to {VIEW[1]:g} s of record {replicate}, seed "
        f"{record.config.seed}. Tracks of points are {ENLARGED:g} times as large as the motion; "
        "the shape of the blade is drawn freely."
    )
    return save_figure(partial(_draw, record.truth, origin), {})(folder, "blade")


def _draw(truth: Truth, origin: str) -> Figure:
    figure = style.new_figure(11.0, 7.2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.25, 1.0))
    first, last = (round(second / truth.step) for second in VIEW)
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
