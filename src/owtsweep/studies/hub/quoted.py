"""Quotes a stored sweep over worlds, in the answer of a run that has its sensors and tuning."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.config.stored import read
from owtsweep.io.tables import read_table
from owtsweep.results.answer import count_names
from owtsweep.results.regret import SUMMARY
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.world import list_departing


def find_reference() -> Path | None:
    """Return the folder of the stored tables, installed or in a checkout; None without one."""
    package = Path(__file__).resolve().parents[2]
    folders = (package / "worlds", package.parents[1] / "results" / "reference" / "worlds")
    return next((folder for folder in folders if (folder / "origin.yaml").is_file()), None)


def quote_worlds(config: HubConfig) -> list[str]:
    """Return a sentence on who regrets least if the world is another one, as it was computed once.

    There is none for other sensors, another tuning or another motion than those of that sweep, or
    if the run is itself over worlds.
    """
    folder = find_reference()
    steady = config.motion.kind == "spectrum" and not list_departing(config)
    if folder is None or config.over is not None or not steady:
        return []
    origin = read(folder / "origin.yaml")
    if (config.tuning, as_mapping(config.sensors)) != (origin["tuning"], origin["sensors"]):
        return []
    summary = read_table(folder, SUMMARY)
    cells = int(summary["least_mean"].sum())
    periods = " ".join(f"{period:g}" for period in summary["natural_period"].unique())
    worst = summary.loc[summary.loc[summary["least_worst"], "worst"].idxmax()]
    far = f"{worst['scheme']} has up to {worst['worst']:.2f} times the least error"
    return [
        f"If the world is another one, by a stored sweep of {cells} cells of its own ({periods} s; "
        f"{origin['worlds']} worlds, `{origin['command']}`, {origin['date']}): least mean regret "
        f"{_count(summary, 'mean')} cells, least worst {_count(summary, 'worst')}; "
        f"{far}, in {worst['worst_world']} (docs/regret.md)."
    ]


def _count(summary: pd.DataFrame, kind: str) -> str:
    return count_names(summary.loc[summary[f"least_{kind}"], "scheme"])
