"""Lists the figures of a replay; matplotlib is imported only when a figure is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.sweep.asked import find_home
from owtsweep.sweep.study import FAILED

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

ESTIMATES = "estimates.parquet"
#: Figures that show a quantity over time; those ending in `_zoom` show some seconds only.
HISTORIES = (
    "position", "position_zoom", "velocity", "velocity_zoom", "acceleration_zoom", "bias",
)  # fmt: skip


def overview(config: ReplayConfig) -> str:
    """Return the main figure: the position over some seconds, or the map of several records."""
    return "position_zoom" if len(config.grid.files) == 1 else "best_scheme_by_record"


def drawings(
    config: ReplayConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str],
) -> dict[str, Drawing]:
    """Return the figures of a run, name -> function that draws and saves it."""
    from owtsweep.studies.replay.facts import pick_facts
    from owtsweep.studies.replay.figures import histories, place, records, spectrum, traces

    if len(config.grid.files) > 1:
        draw = partial(records.draw, config, tables["records"], tables["advice"])
        return {overview(config): save_figure(draw, metadata)}
    open_session = cache(partial(traces.Session, config, config.grid.files[0]))
    advice, failures = tables["advice"], rows[rows["status"] == FAILED]
    # a baseline has no lines in the figures
    advised = str(advice.iloc[0]["recommended"]) if len(advice) else None
    failed = dict(zip(failures["scheme"], failures["reason"], strict=True))

    def draw_history(folder: Path, name: str, quantity: str, *, zoom: bool) -> list[Path]:
        # of a question that is not the latest the folder holds the estimates, else the run folder
        own = folder.parent / ESTIMATES
        path = own if own.is_file() else (find_home(folder.parent) or folder.parent) / ESTIMATES

        def draw() -> Figure:
            session = open_session(path)
            return histories.draw(session, quantity, zoom=zoom, advised=advised, failed=failed)

        return save_figure(draw, metadata)(folder, name)

    history = {
        name: partial(
            draw_history, quantity=name.removesuffix("_zoom"), zoom=name.endswith("_zoom")
        )
        for name in HISTORIES
    }
    others = {
        "spectrum": lambda: spectrum.draw(config, pick_facts(tables["records"])),
        "place_in_map": lambda: place.draw(config, pick_facts(tables["records"])),
    }
    return {**history, **{name: save_figure(draw, metadata) for name, draw in others.items()}}
