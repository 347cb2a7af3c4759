"""Figures 8 to 10 and 13 of Simpson et al. (2025): loads at both cuts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from experiments.simpson2025.damage_figures import INPUT_VECTORS
from experiments.simpson2025.panels import LOOKS, Row, describe, draw_excerpt, draw_rows, finish
from experiments.simpson2025.scenarios import (
    SETUPS,
    WAVES,
    WEIGHTLESS,
    WIND,
    Outcome,
    Outcomes,
    Scenario,
)
from owtsweep.evaluation.signals import compute_mae, divide_by_deviation
from owtsweep.figures import style
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS

Results = Mapping[Scenario, Outcomes]
#: Units of loads -> number of N or N m.
UNITS = {"F": ("MN", 1e6), "M": ("MN m", 1e6)}


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
        draw_excerpt(axes, row)
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
    finish(figure, grid[0], title, note)
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
    return draw_rows(
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
    return draw_rows(
        rows,
        f"Loads on the substructure at the {where}, wind only "
        f"(Fig. {number} of Simpson et al. 2025)",
        f"{describe(first)}. σ: standard deviation of the truth; a constant offset counts in MAE, "
        "and hardly in TRAC, as means are not taken off.",
    )


def _make_row(outcomes: Mapping[str, Outcome], name: str) -> Row:
    """Return a load of all outcomes of one direction, in MN or MN m."""
    first = next(iter(outcomes.values()))
    column = INPUTS.index(name)
    unit, size = UNITS[name[0]]
    return Row(
        f"{name} {first.direction.upper()} ({unit})",
        first.time,
        first.truth.inputs[:, column] / size,
        {key: outcome.estimates.inputs[:, column] / size for key, outcome in outcomes.items()},
        first.judged,
    )
