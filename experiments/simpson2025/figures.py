"""The figures of Simpson et al. (2025) that the study draws.

    python -m experiments.simpson2025.figures [FOLDER] [FIGURE ...]

FOLDER (default: results/tower_paper) gets a PNG and an SVG of each FIGURE (default: of all), of one
record. FIGURE is figure_04 to figure_10, figure_12, figure_13_yaw_0 or figure_13_yaw_30.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from experiments.command import draw_named
from experiments.simpson2025 import damage_figures, input_figures, state_figures
from experiments.simpson2025.scenarios import (
    WAVES,
    WEIGHTLESS,
    WIND,
    Outcomes,
    Scenario,
    run_scenarios,
)
from owtsweep.figures.drawings import save_figure


class Drawn(NamedTuple):
    """A figure: the function that draws it, and the scenarios that the function needs."""

    draw: Callable[[Mapping[Scenario, Outcomes]], Figure]
    needs: tuple[Scenario, ...]


_WIND = tuple(WIND.values())
_DENSE = (WIND["dense_theta_a"],)
FIGURES = {
    "figure_04": Drawn(state_figures.draw_modes, _DENSE),
    "figure_05": Drawn(state_figures.draw_states, _WIND),
    "figure_06": Drawn(state_figures.draw_modal, _DENSE),
    "figure_07": Drawn(damage_figures.draw_damage, _WIND),
    "figure_08": Drawn(input_figures.draw_ground_inputs, _WIND),
    "figure_09": Drawn(input_figures.draw_top_inputs, _WIND),
    "figure_10": Drawn(input_figures.draw_gravity, (*_DENSE, WEIGHTLESS["dense_theta_a"])),
    "figure_12": Drawn(damage_figures.draw_damage_with_waves, tuple(WAVES.values())),
    **{
        f"figure_13_yaw_{yaw}": Drawn(
            partial(input_figures.draw_ground_inputs_with_waves, yaw=yaw),
            (WAVES[yaw, "p_1"], WAVES[yaw, "p_2"]),
        )
        for yaw in (0, 30)
    },
}


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
    chosen = {name: FIGURES[name] for name in names}
    needed = dict.fromkeys(scenario for figure in chosen.values() for scenario in figure.needs)
    results = dict(run_scenarios(needed, replicate, overrides))
    files = []
    for name, figure in chosen.items():
        files += save_figure(partial(figure.draw, results), None)(folder, name)
    return files


if __name__ == "__main__":
    draw_named("results/tower_paper", FIGURES, draw_figures)
