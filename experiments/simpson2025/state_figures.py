"""Figures 4 to 6 of Simpson et al. (2025): modes, states, modal coordinates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from experiments.simpson2025.panels import LOOKS, TRUTH, Row, describe, draw_rows, finish
from experiments.simpson2025.scenarios import SETUPS, WIND, Outcomes, Scenario
from experiments.simpson2025.scores import STATE_HEIGHTS
from owtsweep.figures import style
from owtsweep.figures.lines import make_line
from owtsweep.studies.tower.contract import DIRECTIONS

Results = Mapping[Scenario, Outcomes]


def draw_modes(results: Results) -> Figure:
    """Draw Figure 4: rigid modes and normal modes of the substructure, over height.

    Both directions have one set of modes. The attachment modes, which the print leaves out, are
    drawn thin.
    """
    outcome = next(iter(results.values()))["fa"]
    reduced = outcome.setting.reduced
    figure = style.new_figure(10.0, 4.6)
    count = len(reduced.kinds)
    grid = figure.subplots(1, count, sharey=True)
    for mode, (axes, kind) in enumerate(zip(grid, reduced.kinds, strict=True)):
        shape = reduced.basis[::2, mode]
        axes.axvline(0.0, color="0.6", linewidth=0.8)
        axes.plot(
            shape / np.abs(shape).max(), outcome.heights, color="#0072B2",
            linewidth=0.9 if kind == "attachment" else 1.8, marker=".", markersize=4,
        )  # fmt: skip
        axes.set_title(f"{kind}\n{reduced.omega[mode] / (2.0 * np.pi):.3g} Hz", fontsize=9)
        axes.set_xlim(-1.2, 1.2)
    grid[0].set_ylabel("height above the ground (m)")
    figure.supxlabel("displacement over its largest", fontsize=9)
    figure.suptitle(
        "Modes of the free substructure (Fig. 4 of Simpson et al. 2025), each direction",
        x=0.01, ha="left",
    )  # fmt: skip
    return figure


def draw_states(results: Results) -> Figure:
    """Draw Figure 5: displacement and rotation at the ground and at 15 m, fore-aft."""
    outcomes = {SETUPS[name]: results[scenario]["fa"] for name, scenario in WIND.items()}
    first = next(iter(outcomes.values()))
    rows = []
    for height in STATE_HEIGHTS:
        dof = 2 * first.find_node(height)
        for name, unit, at in ((f"x{height}", "m", dof), (f"θ{height}", "rad", dof + 1)):
            truth = first.truth.displacement[:, at]
            told = {key: each.estimates.displacement[:, at] for key, each in outcomes.items()}
            rows.append(Row(f"{name} FA ({unit})", first.time, truth, told, first.judged))
    return draw_rows(
        rows,
        "Displacement and rotation at 0 m and 15 m, wind only (Fig. 5 of Simpson et al. 2025)",
        f"{describe(first)}. TRAC and FRAC as printed, means included; both are near 1 for signals "
        "with a large mean. σ: standard deviation of the truth.",
    )


def draw_modal(results: Results) -> Figure:
    """Draw Figure 6: all modal coordinates with Dense: θ-a, true and estimated."""
    outcomes = results[WIND["dense_theta_a"]]
    name = SETUPS["dense_theta_a"]
    first = outcomes["fa"]
    kinds = first.setting.reduced.kinds
    figure = style.new_figure(11.0, 1.0 + 1.7 * len(kinds) / 2)
    grid = figure.subplots(len(kinds) // 2, 4, squeeze=False)
    for side, direction in enumerate(DIRECTIONS):
        outcome = outcomes[direction]
        true, estimated = map(
            outcome.project, (outcome.truth.displacement, outcome.estimates.displacement)
        )
        for mode, kind in enumerate(kinds):
            axes = grid[mode // 2, 2 * (mode % 2) + side]
            for piece in make_line(outcome.time, true[:, mode]):
                axes.plot(*piece, **TRUTH)
            for piece in make_line(outcome.time, estimated[:, mode]):
                axes.plot(
                    *piece, linewidth=1.0, label=f"estimate, {name}", **LOOKS[name], zorder=2.2
                )
            judged = np.concatenate([true[outcome.judged, mode], estimated[outcome.judged, mode]])
            room = 0.1 * float(np.ptp(judged))
            axes.set_ylim(judged.min() - room, judged.max() + room)
            axes.axvspan(0.0, outcome.time[outcome.judged][0], color="0.93", zorder=0)
            axes.set_title(f"{kind} {mode + 1}, {direction.upper()}", fontsize=9)
            axes.set_xlim(0.0, outcome.time[-1])
    for axes in grid[-1]:
        axes.set_xlabel("time (s)")
    for axes in grid[:, 0]:
        axes.set_ylabel("z (m √kg)", fontsize=8)
    title = "Modal coordinates, wind only (Fig. 6 of Simpson et al. 2025)"
    note = (
        f"{describe(first)}. Modes have a mass of 1 kg; rigid 1 is translation, rigid 2 rotation "
        "about the centre of mass: inclinometers see the latter, so only translation drifts. "
        "(Modes that mix both, as eigenvectors of the eigenvalue 0 may, would drift both.) Grey: "
        "not judged."
    )
    finish(figure, grid[0, 0], title, note)
    return figure
