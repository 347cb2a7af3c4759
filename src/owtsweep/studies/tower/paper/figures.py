"""The figures of Simpson et al. (2025) that the study draws, by name, and how to make them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from owtsweep.figures.drawings import save_figure
from owtsweep.studies.tower.paper import damage_figures, input_figures, state_figures
from owtsweep.studies.tower.paper.judging import WAVES, WEIGHTLESS, WIND
from owtsweep.studies.tower.paper.scenarios import Outcomes, Scenario, run_scenarios

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
