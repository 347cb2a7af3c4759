"""The figures of a replay; matplotlib is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.studies.replay.config import ReplayConfig

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


#: Figure -> the quantity whose time history it shows, and whether it is zoomed in.
HISTORIES = {
    "position": ("position", False),
    "position_zoom": ("position", True),
    "velocity": ("velocity", False),
    "velocity_zoom": ("velocity", True),
    "acceleration_zoom": ("acceleration", True),
    "bias": ("bias", False),
}


def overview(config: ReplayConfig) -> str:
    """Name of the main figure: the position of one record zoomed in, or the map over many."""
    return "position_zoom" if len(config.grid.files) == 1 else "best_scheme_by_record"


def drawings(
    config: ReplayConfig,
    tables: Mapping[str, pd.DataFrame],
    metadata: Mapping[str, str] | None = None,
) -> dict[str, Drawing]:
    """The figures of a run by name: time histories of one record, or the map over many."""
    single = len(config.grid.files) == 1
    figures = _figures_of_one(config, tables) if single else _figures_of_many(config, tables)
    return {name: save_figure(draw, metadata) for name, draw in figures.items()}


def _figures_of_one(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame]
) -> dict[str, Callable[[], Figure]]:
    from owtsweep.studies.replay.figures import histories, place, spectrum
    from owtsweep.studies.replay.session import run_session
    from owtsweep.studies.replay.states import NO_STATES, collect_filter_states

    recorded = cache(lambda: run_session(config, config.grid.files[0]))
    states = cache(lambda: collect_filter_states(config, recorded()))

    def history(name: str) -> Callable[[], Figure]:
        quantity, zoom = HISTORIES[name]
        filtered = quantity in ("acceleration", "bias")
        return lambda: histories.draw(
            config, recorded(), states() if filtered else NO_STATES, quantity, zoom=zoom,
            advised=_find_advised(tables),
        )  # fmt: skip

    return {
        **{name: history(name) for name in HISTORIES},
        "spectrum": lambda: spectrum.draw(config, tables["records"].iloc[0]),
        "place_in_map": lambda: place.draw(config, tables["records"].iloc[0]),
    }


def _figures_of_many(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame]
) -> dict[str, Callable[[], Figure]]:
    from owtsweep.studies.replay.figures import records

    return {
        "best_scheme_by_record": lambda: records.draw(config, tables["records"], tables["advice"])
    }


def _find_advised(tables: Mapping[str, pd.DataFrame]) -> str | None:
    """The scheme whose uncertainty the figures show."""
    advised = tables["advice"]
    return str(advised.iloc[0]["best"]) if len(advised) else None
