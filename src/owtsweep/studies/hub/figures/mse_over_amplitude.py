"""Draws the MSE over amplitude at one natural period, like figures 15-17 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from owtsweep.figures import curves, style
from owtsweep.studies.hub.listed import BASELINES
from owtsweep.studies.hub.world import AMPLITUDE, NATURAL_PERIOD

#: The panels: measure -> label of its axis.
PANELS = {"position": "position MSE, x + y (m²)", "velocity": "velocity MSE, vx + vy (m²/s²)"}


def draw(
    summary: pd.DataFrame,
    natural_period: float,
    schemes: Sequence[str],
    *,
    window: str,
    tuning: str,
    coinciding: Sequence[Sequence[str]] = (),
    baselines: Sequence[str] = (),
    printed: pd.DataFrame | None = None,
    notes: Sequence[str] = (),
) -> Figure:
    """Draw position and velocity MSE of schemes against the amplitude, on log-log axes.

    summary: the table summary.csv of a run.
    natural_period: one of the natural periods in `summary`, in s.
    schemes: in the order of the legend.
    window, tuning: for the title; rows of other windows are not drawn.
    coinciding: groups of schemes with equal results, for the footnote.
    baselines: drawn as thin lines.
    printed: published numbers, of which those at this natural period are drawn as hollow marks.
        Columns: table, natural_period (s), amplitude (m), scheme, measure, value, note.
    notes: sentences for the footnote.
    Raises InputError if `summary` has no data at that period in that window.
    """
    here = {NATURAL_PERIOD: natural_period}
    curves.choose(summary, schemes, window, here)  # baselines alone are no figure
    shown = curves.choose(summary, [*schemes, *baselines], window, here)
    marks, label, notes = None, "", [*_explain_baselines(baselines), *notes]
    if printed is not None:
        marks = _choose_marks(printed, natural_period, shown["amplitude"], schemes)
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
        f"{style.describe_window(window)}, tuning: {tuning}",
        points=marks,
        points_label=label,
        coinciding=coinciding,
        thin=baselines,
        notes=notes,
    )


def _explain_baselines(baselines: Sequence[str]) -> list[str]:
    if not baselines:
        return []
    told = "; ".join(f"{name}, {BASELINES[name].sentence}" for name in baselines)
    return [f"Thin: baselines ({told}). The axes have the range of the schemes."]


def _choose_marks(
    printed: pd.DataFrame,
    natural_period: float,
    amplitudes: pd.Series[float],
    schemes: Sequence[str],
) -> pd.DataFrame:
    """Return the published numbers of schemes at a natural period (s), in a range of amplitudes."""
    inside = printed["amplitude"].between(amplitudes.min(), amplitudes.max())
    here = np.isclose(printed["natural_period"], natural_period) & inside
    return printed[here & printed["scheme"].isin(list(schemes))]
