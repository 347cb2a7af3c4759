"""The figures of a replay; matplotlib only once they are used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.studies.replay.config import ReplayConfig

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


#: Figure -> what of the time histories it shows, and whether zoomed in.
HISTORIES = {
    "position": ("position", False),
    "position_zoom": ("position", True),
    "velocity": ("velocity", False),
    "velocity_zoom": ("velocity", True),
    "acceleration_zoom": ("acceleration", True),
    "bias": ("bias", False),
}
OVERVIEW = "overview"


def draw_all(
    config: ReplayConfig,
    tables: Mapping[str, pd.DataFrame],
    folder: Path,
    *,
    only: str | None = None,
    metadata: Mapping[str, str] | None = None,
) -> list[Path]:
    """Draw the figures of a run, or the one called `only`; returns the files.

    `overview` is the zoomed position of a single record, and of many the map over them. A figure
    that this run cannot have is left out with a logged warning, unless it is the one asked for.

    Raises
    ------
    InputError
        If there is no figure of that name, or the run cannot have it.
    """
    from owtsweep.figures import style
    from owtsweep.figures.drawings import Drawing, draw_each

    single = len(config.grid.files) == 1
    drawings = _of_one(config, tables) if single else _of_many(config, tables)
    if only == OVERVIEW:
        only = "position_zoom" if single else "best_scheme_by_record"

    def saved(draw: Callable[[], Figure]) -> Drawing:
        def save(target: Path, name: str) -> list[Path]:
            with style.context():
                return style.save(draw(), target, name, metadata)

        return save

    return draw_each({name: saved(draw) for name, draw in drawings.items()}, folder, only)


def _of_one(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame]
) -> dict[str, Callable[[], Figure]]:
    from owtsweep.studies.replay.figures import histories, place, spectrum
    from owtsweep.studies.replay.session import run_session
    from owtsweep.studies.replay.states import NO_STATES, collect_filter_states

    known = cache(lambda: run_session(config, config.grid.files[0]))
    states = cache(lambda: collect_filter_states(config, known()))

    def history(name: str) -> Callable[[], Figure]:
        quantity, zoom = HISTORIES[name]
        filtered = quantity in ("acceleration", "bias")
        return lambda: histories.draw(
            config, known(), states() if filtered else NO_STATES, quantity, zoom=zoom,
            advised=_advised(tables),
        )  # fmt: skip

    return {
        **{name: history(name) for name in HISTORIES},
        "spectrum": lambda: spectrum.draw(config, tables["records"].iloc[0]),
        "place_in_map": lambda: place.draw(config, tables["records"].iloc[0]),
    }


def _of_many(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame]
) -> dict[str, Callable[[], Figure]]:
    from owtsweep.studies.replay.figures import records

    return {
        "best_scheme_by_record": lambda: records.draw(config, tables["records"], tables["advice"])
    }


def _advised(tables: Mapping[str, pd.DataFrame]) -> str | None:
    """The scheme whose uncertainty the figures show."""
    advised = tables["advice"]
    return str(advised.iloc[0]["best"]) if len(advised) else None
