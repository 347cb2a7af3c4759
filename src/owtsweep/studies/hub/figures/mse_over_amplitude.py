"""Draws the MSE over amplitude at one natural period, like figures 15-17 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from owtsweep.figures import curves, style
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.listed import BASELINES, list_baselines, scheme_names
from owtsweep.studies.hub.world import AMPLITUDE, NATURAL_PERIOD

#: The panels: measure -> label of its axis.
PANELS = {"position": "position MSE, x + y (m²)", "velocity": "velocity MSE, vx + vy (m²/s²)"}
#: What is said of means over the records that all schemes of a cell have, where some have more.
SHARED = "Means are over the records that all schemes of a cell have, fewer than the map's."


def draw(
    config: HubConfig,
    summary: pd.DataFrame,
    natural_period: float,
    coinciding: Sequence[Sequence[str]] = (),
    printed: pd.DataFrame | None = None,
) -> Figure:
    """Draw position and velocity MSE of schemes against the amplitude, on log-log axes.

    Baselines are thin lines. Drawn is the window that is judged.

    summary: the table summary.csv of a run.
    natural_period: one of the natural periods in `summary`, in s.
    coinciding: groups of schemes with equal results, for the footnote.
    printed: published numbers, of which those at this natural period are drawn as hollow marks.
        Columns: table, natural_period (s), amplitude (m), scheme, measure, value, note.
    Raises InputError if `summary` has no data at that period in that window.
    """
    schemes, baselines = scheme_names(config), list_baselines(config)
    window, here = config.measures.window, {NATURAL_PERIOD: natural_period}
    curves.choose(summary, schemes, window, here)  # baselines alone are no figure
    shown = curves.choose(summary, [*schemes, *baselines], window, here)
    marks, label, notes = None, "", []
    if baselines:
        told = "; ".join(f"{name}, {BASELINES[name].sentence}" for name in baselines)
        notes.append(f"Thin: baselines ({told}). The axes have the range of the schemes.")
    if config.grid.decides and config.engine != "expected":
        notes.append(SHARED)
    if printed is not None:
        drawn = shown["amplitude"]
        inside = printed["amplitude"].between(drawn.min(), drawn.max())
        inside &= np.isclose(printed["natural_period"], natural_period)
        marks = printed[inside & printed["scheme"].isin(schemes)]
        notes += [
            f"Table {row['table']}, {row['scheme']}: {row['note']}."
            for row in marks[marks["note"] != ""].to_dict("records")
        ]
        if tables := sorted(set(marks["table"])):
            noun = "Tables" if len(tables) > 1 else "Table"
            label = f"hollow: published\n({noun} {', '.join(map(str, tables))})"
    return curves.draw(
        shown,
        schemes,
        AMPLITUDE,
        PANELS,
        title=f"Mean squared error over amplitude, natural period {natural_period:g} s\n"
        f"{style.describe_window(window)}, tuning: {config.tuning_name}",
        points=marks,
        points_label=label,
        coinciding=coinciding,
        thin=baselines,
        notes=notes,
    )
