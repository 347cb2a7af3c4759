"""Rows of panels: a signal over the record, an excerpt of it, and how well estimates follow it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.simpson2025.scenarios import NOISE, SETUPS, Outcome
from owtsweep.arrays import Array
from owtsweep.evaluation.signals import compute_frac, compute_mae, compute_trac, divide_by_deviation
from owtsweep.figures import style
from owtsweep.figures.lines import clip, make_line

#: Looks of estimates, by what stands in the legend.
LOOKS: dict[str, dict[str, Any]] = {
    SETUPS["dense_x_a"]: {"color": "#0072B2", "linestyle": "-"},
    SETUPS["dense_theta_a"]: {"color": "#E69F00", "linestyle": (0, (5, 2))},
    SETUPS["sparse_theta_a"]: {"color": "#009E73", "linestyle": (0, (3, 1, 1, 1))},
    "p₁: no wave input": {"color": "#0072B2", "linestyle": (0, (3, 1, 1, 1))},
    "p₂: triangular wave load": {"color": "#D55E00", "linestyle": (0, (5, 2))},
    "with gravity": {"color": "#CC79A7", "linestyle": "-"},
    "without gravity": {"color": "#56B4E9", "linestyle": (0, (5, 2))},
}
TRUTH: dict[str, Any] = {"color": "black", "linewidth": 1.6, "label": "truth", "zorder": 2.15}
#: Length in s of an excerpt, and where it begins as a part of the record.
EXCERPT, EXCERPT_AT = 10.0, 0.6
#: Smallest number on the axis of a criterion.
FLOOR = 1e-7


@dataclass(frozen=True)
class Row:
    """A signal and its estimates.

    Attributes
    ----------
    label
        Name and unit.
    time
        s, shape (steps,).
    truth
        Shape (steps,).
    estimates
        Legend entry -> shape (steps,).
    judged
        The samples that are judged.
    """

    label: str
    time: Array
    truth: Array
    estimates: Mapping[str, Array]
    judged: slice


def describe(outcome: Outcome) -> str:
    """Return where a figure's numbers come from: truth, noise, tuning, record and seed."""
    config = outcome.config
    sea = config.waves
    waves = f"waves Hs {sea.hs:g} m, Tp {sea.tp:g} s, yaw {sea.yaw:g}°" if sea.hs else "no waves"
    return (
        f"Truth: {config.structure.name}, linear, wind {config.wind.speed:g} m/s, {waves}; noise "
        f"{NOISE:g} %; AKF, tuning {outcome.scenario.tuning}; seed {config.seed}, record "
        f"{outcome.replicate}"
    )


def draw_rows(rows: Sequence[Row], title: str, note: str, *, spectra: bool = False) -> Figure:
    """Draw rows of three panels: the record, an excerpt, and criteria (or spectra)."""
    figure = style.new_figure(11.0, 0.9 + 2.1 * len(rows))
    grid = figure.subplots(len(rows), 3, width_ratios=(1.3, 1.2, 1.2), squeeze=False)
    for line, row in zip(grid, rows, strict=True):
        _draw_record(line[0], row)
        draw_excerpt(line[1], row)
        if spectra:
            draw_spectra(line[2], row)
        else:
            _draw_criteria(line[2], row)
    third = "power spectral density" if spectra else "distance from the truth (less is better)"
    titles = ["whole record; grey: not judged", f"excerpt of {EXCERPT:g} s", third]
    for axes, text in zip(grid[0], titles, strict=True):
        axes.set_title(text, fontsize=10)
    for axes in grid[-1, : 3 if spectra else 2]:
        axes.set_xlabel("time (s)")
    if spectra:
        grid[-1, 2].set_xlabel("frequency (Hz)")
    finish(figure, grid[0, 0], title, note)
    return figure


def finish(figure: Figure, axes: Axes, title: str, note: str) -> None:
    """Add a legend of a panel's lines, a title and a footnote to a figure."""
    handles, labels = axes.get_legend_handles_labels()
    style.add_legend_above(figure, handles, title, len(labels))
    for text, label in zip(figure.legends[0].get_texts(), labels, strict=True):
        text.set_text(label)
    style.footnote(figure, note)


def _draw_record(axes: Axes, row: Row) -> None:
    _plot(axes, row, (0.0, float(row.time[-1])))
    axes.axvspan(0.0, row.time[row.judged][0], color="0.93", zorder=0)
    axes.set_ylabel(row.label)
    _limit(axes, row, row.judged, 0.3)


def draw_excerpt(axes: Axes, row: Row) -> None:
    """Draw a signal and its estimates over some seconds; the truth sets the limits."""
    begin = EXCERPT_AT * float(row.time[-1])
    view = (begin, begin + EXCERPT)
    _plot(axes, row, view)
    inside = (row.time >= view[0]) & (row.time <= view[1])
    _limit(axes, row, slice(*(np.flatnonzero(inside)[[0, -1]] + [0, 1])), 0.6)


def _plot(axes: Axes, row: Row, view: tuple[float, float]) -> None:
    for piece in make_line(*clip(row.time, row.truth, view)):
        axes.plot(*piece, **TRUTH)
    # The worst estimate lies below the others, which it would hide.
    error = {n: np.abs(v - row.truth)[row.judged].mean() for n, v in row.estimates.items()}
    ranks = sorted(error, key=error.__getitem__, reverse=True)
    for name, values in row.estimates.items():
        for piece in make_line(*clip(row.time, values, view)):
            order = 2.1 + 0.1 * (ranks.index(name) + (len(ranks) == 1))
            axes.plot(*piece, linewidth=1.1, label=name, zorder=order, **LOOKS[name])
    axes.set_xlim(*view)


def _limit(axes: Axes, row: Row, part: slice, margin: float) -> None:
    """Set limits about the truth, and say which estimates are outside most of the time."""
    truth = row.truth[part]
    low, high = float(truth.min()), float(truth.max())
    room = margin * (high - low)
    axes.set_ylim(low - room, high + room)
    unit = row.label.partition("(")[2].rstrip(")")
    gone = [
        f"{name} (to {np.abs(values[part]).max():.3g} {unit})"
        for name, values in row.estimates.items()
        if np.mean((values[part] < low - room) | (values[part] > high + room)) > 0.5
    ]
    if gone:
        axes.text(
            0.02, 0.97, "beyond: " + "\n".join(gone), transform=axes.transAxes, fontsize=7,
            va="top", bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        )  # fmt: skip


def _draw_criteria(axes: Axes, row: Row) -> None:
    """Draw 1 - TRAC, 1 - FRAC and MAE / sigma as bars, one colour per estimate."""
    width = 0.8 / len(row.estimates)
    for place, (name, values) in enumerate(row.estimates.items()):
        true, estimate = row.truth[row.judged], values[row.judged]
        heights = np.array(
            [
                1.0 - compute_trac(true, estimate),
                1.0 - compute_frac(true, estimate),
                divide_by_deviation(compute_mae(true, estimate), true),
            ]
        )
        at = np.arange(3) + (place - 0.5 * (len(row.estimates) - 1)) * width
        heights = np.maximum(heights, FLOOR)
        axes.bar(at, heights, width, color=LOOKS[name]["color"])
        for x, height in zip(at, heights, strict=True):
            axes.text(x, height * 1.3, f"{height:.0e}", ha="center", fontsize=5.5)
    axes.set_yscale("log")
    axes.set_ylim(FLOOR, max(10.0 * axes.get_ylim()[1], 1.0))
    axes.set_xticks(range(3), ["1 − TRAC", "1 − FRAC", "MAE / σ"])


def draw_spectra(axes: Axes, row: Row) -> None:
    """Draw power spectral densities of a signal and its estimates, to 1 Hz."""
    from experiments.simpson2025.scores import find_density

    step = float(row.time[1] - row.time[0])
    for values, look in [
        (row.truth, TRUTH),
        *((v, {"linewidth": 1.1, "label": n, **LOOKS[n]}) for n, v in row.estimates.items()),
    ]:
        frequency, density = find_density(values[row.judged], step)
        shown = (frequency > 0.0) & (frequency <= 1.0)
        axes.semilogy(frequency[shown], density[shown], **look)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylabel("unit²/Hz")
