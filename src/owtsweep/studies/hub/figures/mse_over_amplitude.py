"""Draws the MSE over amplitude at one natural period, like figures 15-17 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure

from owtsweep.figures import curves, style
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import BASELINES, list_baselines, scheme_names
from owtsweep.studies.hub.worlds import AMPLITUDE, NATURAL_PERIOD

#: The panels: measure -> label of its axis.
PANELS = {"position": "position MSE, x + y (m²)", "velocity": "velocity MSE, vx + vy (m²/s²)"}
#: What is said of means over the records that all schemes of a cell have, where some have more.
SHARED = "Means are over the records that all schemes of a cell have, fewer than the map's."


def draw(
    config: HubConfig,
    summary: pd.DataFrame,
    natural_period: float,
    coinciding: Sequence[Sequence[str]] = (),
) -> Figure:
    """Draw position and velocity MSE of schemes against the amplitude, on log-log axes.

    Baselines are thin lines. Drawn is the window that is judged.

    summary: the table summary.csv of a run.
    natural_period: one of the natural periods in `summary`, in s.
    coinciding: groups of schemes with equal results, for the footnote.
    Raises InputError if `summary` has no data at that period in that window.
    """
    schemes, baselines = scheme_names(config), list_baselines(config)
    window, here = config.measures.window, {NATURAL_PERIOD: natural_period}
    curves.choose(summary, schemes, window, here)  # baselines alone are no figure
    shown = curves.choose(summary, [*schemes, *baselines], window, here)
    notes = []
    if baselines:
        told = "; ".join(f"{name}, {BASELINES[name].sentence}" for name in baselines)
        notes.append(f"Thin: baselines ({told}). The axes have the range of the schemes.")
    if config.grid.decides and config.engine != "expected":
        notes.append(SHARED)
    return curves.draw(
        shown,
        schemes,
        AMPLITUDE,
        PANELS,
        title=f"Mean squared error over amplitude, natural period {natural_period:g} s\n"
        f"{style.describe_window(window)}, tuning: {config.tuning_name}",
        coinciding=coinciding,
        thin=baselines,
        notes=notes,
    )
