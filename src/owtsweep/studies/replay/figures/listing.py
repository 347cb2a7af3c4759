"""Lists the figures of a replay; matplotlib is imported only when a figure is drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.studies.replay.config import ReplayConfig

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

#: Figures that show a quantity over time; those ending in `_zoom` show some seconds only.
HISTORIES = (
    "position", "position_zoom", "velocity", "velocity_zoom", "acceleration_zoom", "bias",
)  # fmt: skip


def overview(config: ReplayConfig) -> str:
    """Return the main figure: the position over some seconds, or the map of several records."""
    return "position_zoom" if len(config.grid.files) == 1 else "best_scheme_by_record"


def drawings(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame], metadata: Mapping[str, str]
) -> dict[str, Drawing]:
    """Return the figures of a run, name -> function that draws and saves it."""
    if len(config.grid.files) == 1:
        figures = _figures_of_one(config, tables)
    else:
        from owtsweep.studies.replay.figures import records

        figures = {
            overview(config): lambda: records.draw(config, tables["records"], tables["advice"])
        }
    return {name: save_figure(draw, metadata) for name, draw in figures.items()}


def _figures_of_one(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame]
) -> dict[str, Callable[[], Figure]]:
    from owtsweep.studies.replay.facts import pick_facts
    from owtsweep.studies.replay.figures import histories, place, spectrum
    from owtsweep.studies.replay.session import collect_filter_states, run_session

    recorded = cache(lambda: run_session(config, config.grid.files[0]))
    states = cache(lambda: collect_filter_states(config, recorded()))
    advice = tables["advice"]
    # a baseline has no lines in the figures
    advised = str(advice.iloc[0]["recommended"]) if len(advice) else None

    def history(name: str) -> Callable[[], Figure]:
        quantity, zoom = name.removesuffix("_zoom"), name.endswith("_zoom")
        return lambda: histories.draw(
            config, recorded(), states, quantity, zoom=zoom, advised=advised
        )

    return {
        **{name: history(name) for name in HISTORIES},
        "spectrum": lambda: spectrum.draw(config, pick_facts(tables["records"])),
        "place_in_map": lambda: place.draw(config, pick_facts(tables["records"])),
    }
