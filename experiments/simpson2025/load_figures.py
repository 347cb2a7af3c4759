"""Figures 7 to 10, 12 and 13 of Simpson et al. (2025): loads at both cuts, and damage."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from experiments.simpson2025 import panels
from experiments.simpson2025.panels import LOOKS, describe
from experiments.simpson2025.scenarios import (
    SETUPS,
    WAVES,
    WEIGHTLESS,
    WIND,
    Outcome,
    Outcomes,
    Scenario,
)
from experiments.simpson2025.scores import damages_of
from owtsweep.evaluation.signals import compute_mae, divide_by_deviation
from owtsweep.figures import style
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS

Results = Mapping[Scenario, Outcomes]
#: Names of directions in titles.
WORDS = {"fa": "fore-aft", "ss": "side-side"}
#: Names of the input vectors in legends.
INPUT_VECTORS = {"p_1": "p₁: no wave input", "p_2": "p₂: triangular wave load"}
#: Units of loads -> number of N or N m.
UNITS = {"F": ("MN", 1e6), "M": ("MN m", 1e6)}
#: Ratios of damage that the panels show; others are marked at the edge.
SHOWN = (0.3, 3.0)


def draw_damage(results: Results) -> Figure:
    """Draw Figure 7: damage along the height, three set-ups, wind only."""
    figure = style.new_figure(11.0, 5.4)
    grid = figure.subplots(1, 4, sharey=True)
    for side, direction in enumerate(DIRECTIONS):
        outcomes = {SETUPS[name]: results[WIND[name]][direction] for name in SETUPS}
        _draw_pair(grid[2 * side], grid[2 * side + 1], outcomes, WORDS[direction])
    first = results[WIND["dense_x_a"]]["fa"]
    grid[0].set_ylabel("height above the ground (m)")
    title = "Damage along the substructure, wind only (Fig. 7 of Simpson et al. 2025)"
    panels.finish(figure, grid[0], title, _note(first))
    return figure


def draw_damage_with_waves(results: Results) -> Figure:
    """Draw Figure 12: damage with waves, with and without an input for them, Sparse: θ-a."""
    figure = style.new_figure(11.0, 9.6)
    grid = figure.subplots(2, 4, sharey=True)
    for line, yaw in zip(grid, (0, 30), strict=True):
        for side, direction in enumerate(DIRECTIONS):
            outcomes = {
                text: results[WAVES[yaw, inputs]][direction]
                for inputs, text in INPUT_VECTORS.items()
            }
            words = f"yaw {yaw}°, {WORDS[direction]}"
            _draw_pair(line[2 * side], line[2 * side + 1], outcomes, words)
        line[0].set_ylabel("height above the ground (m)")
    first = results[WAVES[0, "p_1"]]["fa"]
    title = "Damage along the substructure, wind and waves (Fig. 12 of Simpson et al. 2025)"
    note = _note(first).replace(", yaw 0°", "")
    panels.finish(figure, grid[0, 0], title, f"Sensors {SETUPS['sparse_theta_a']}. {note}")
    return figure


def _draw_pair(left: Axes, right: Axes, outcomes: Mapping[str, Outcome], words: str) -> None:
    """Draw damages on the left, and estimated over true ones on the right."""
    first = next(iter(outcomes.values()))
    true, _ = damages_of(first)
    left.plot(true, first.heights, **panels.TRUTH)
    for place, (name, outcome) in enumerate(outcomes.items()):
        _, estimated = damages_of(outcome)
        left.plot(estimated, outcome.heights, label=name, linewidth=1.3, **LOOKS[name])
        ratio = np.clip(estimated / true, *SHOWN)
        right.plot(ratio, outcome.heights, linewidth=1.3, **LOOKS[name])
        beyond = (estimated / true < SHOWN[0]) | (estimated / true > SHOWN[1])
        right.plot(ratio[beyond], outcome.heights[beyond], ">", color=LOOKS[name]["color"])
        for at in np.flatnonzero(beyond):
            right.text(
                ratio[at], outcome.heights[at], f"{estimated[at] / true[at]:.2g}   ", fontsize=7,
                ha="right", va="bottom" if place else "top", color=LOOKS[name]["color"], zorder=4,
                bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
            )  # fmt: skip
    left.set_xscale("log")
    left.xaxis.set_minor_formatter(NullFormatter())
    left.set_title(words, fontsize=10)
    left.set_xlabel("damage in 10 minutes" if _is_ten_minutes(first) else "damage")
    right.axvspan(0.85, 1.15, color="0.92", zorder=0)
    right.axvline(1.0, color="black", linewidth=1.0)
    right.set_xscale("log")
    right.set_xlim(0.95 * SHOWN[0], 1.05 * SHOWN[1])
    right.set_xticks(
        [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0], ["0.3", "0.5", "0.7", "1", "1.5", "2", "3"]
    )
    right.minorticks_off()
    right.set_title("estimated / true", fontsize=10)
    right.set_xlabel("ratio; grey: ±15 %")
    level = first.setting.cut.heights[0]
    for axes in (left, right):
        axes.axhline(-level, color="#56B4E9", linewidth=0.8)


def _is_ten_minutes(outcome: Outcome) -> bool:
    record = outcome.config.record
    return abs(record.duration - record.settling - 600.0) < 1.0


def _note(outcome: Outcome) -> str:
    return (
        f"{describe(outcome)}. S-N curve as printed (m = 5, log a = 13.617), Goodman with 500 MPa; "
        "damage at a node of the mesh, of bending in one direction, on a logarithmic axis: the "
        "share of a weld's life. Blue: mean sea level. Triangles: beyond the axis, with the ratio."
    )


def draw_ground_inputs(results: Results) -> Figure:
    """Draw Figure 8: force and moment at the ground, both directions, three set-ups."""
    return _draw_cut(results, INPUTS[:2], "ground", 8)


def draw_top_inputs(results: Results) -> Figure:
    """Draw Figure 9: force and moment at the top of the tower, three set-ups."""
    return _draw_cut(results, INPUTS[2:], "tower top", 9)


def draw_gravity(results: Results) -> Figure:
    """Draw Figure 10: F175 fore-aft with and without gravity in the truth, Dense: θ-a."""
    worlds = {
        "with gravity": results[WIND["dense_theta_a"]],
        "without gravity": results[WEIGHTLESS["dense_theta_a"]],
    }
    figure = style.new_figure(11.0, 4.6)
    grid = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.3))
    grid[1].sharey(grid[0])
    name = SETUPS["dense_theta_a"]
    for axes, (words, outcomes) in zip(grid, worlds.items(), strict=False):
        row = _make_row({name: outcomes["fa"]}, "F175")
        panels.draw_excerpt(axes, row)
        judged = row.judged
        offset = float(np.mean(row.estimates[name][judged] - row.truth[judged]))
        share = 100.0 * offset / float(np.mean(row.truth[judged]))
        axes.set_title(f"{words}:\nmean error {1e3 * offset:.2g} kN ({share:.1g} %)", fontsize=9)
        axes.set_xlabel("time (s)")
    grid[0].set_ylabel("F175 FA (MN)")
    labels = [(n, d) for d in DIRECTIONS for n in INPUTS]
    for place, (words, outcomes) in enumerate(worlds.items()):
        heights = []
        for load, direction in labels:
            row = _make_row({name: outcomes[direction]}, load)
            true, estimate = row.truth[row.judged], row.estimates[name][row.judged]
            heights.append(float(divide_by_deviation(compute_mae(true, estimate), true)))
        at = np.arange(len(labels)) + (place - 0.5) * 0.4
        grid[2].bar(at, heights, 0.4, color=LOOKS[words]["color"], label=words)
    grid[2].set_yscale("log")
    texts = [f"{n}\n{d.upper()}" for n, d in labels]
    grid[2].set_xticks(range(len(labels)), texts, fontsize=7)
    grid[2].set_title("MAE / σ of all inputs", fontsize=9)
    grid[2].legend(frameon=False, fontsize=8)
    title = "Offset of the shear force at the tower top (Fig. 10 of Simpson et al. 2025)"
    note = (
        f"{describe(worlds['with gravity']['fa'])}. The estimators' model has no gravity in either "
        "case. σ: standard deviation of the truth. Wind loads are those of one record: both truths "
        "differ by the weight alone."
    )
    panels.finish(figure, grid[0], title, note)
    return figure


def draw_ground_inputs_with_waves(results: Results, yaw: int) -> Figure:
    """Draw a half of Figure 13: loads at the ground with waves, with and without wave input."""
    rows = []
    for direction in DIRECTIONS:
        outcomes = {
            text: results[WAVES[yaw, inputs]][direction] for inputs, text in INPUT_VECTORS.items()
        }
        rows += [_make_row(outcomes, name) for name in INPUTS[:2]]
    first = results[WAVES[yaw, "p_1"]]["fa"]
    return panels.draw_rows(
        rows,
        f"Loads at the ground, wind and waves, yaw {yaw}° (Fig. 13 of Simpson et al. 2025)",
        f"Sensors {SETUPS['sparse_theta_a']}. {describe(first)}. Spectra by Welch's method, pieces "
        "of 200 s, mean taken off; unit² as on the left.",
        spectra=True,
    )


def _draw_cut(results: Results, names: tuple[str, ...], where: str, number: int) -> Figure:
    rows = []
    for direction in DIRECTIONS:
        outcomes = {SETUPS[name]: results[scenario][direction] for name, scenario in WIND.items()}
        rows += [_make_row(outcomes, name) for name in names]
    first = results[WIND["dense_x_a"]]["fa"]
    return panels.draw_rows(
        rows,
        f"Loads on the substructure at the {where}, wind only "
        f"(Fig. {number} of Simpson et al. 2025)",
        f"{describe(first)}. σ: standard deviation of the truth; a constant offset counts in MAE, "
        "and hardly in TRAC, as means are not taken off.",
    )


def _make_row(outcomes: Mapping[str, Outcome], name: str) -> panels.Row:
    """Return a load of all outcomes of one direction, in MN or MN m."""
    first = next(iter(outcomes.values()))
    column = INPUTS.index(name)
    unit, size = UNITS[name[0]]
    return panels.Row(
        f"{name} {first.direction.upper()} ({unit})",
        first.time,
        first.truth.inputs[:, column] / size,
        {key: outcome.estimates.inputs[:, column] / size for key, outcome in outcomes.items()},
        first.judged,
    )
