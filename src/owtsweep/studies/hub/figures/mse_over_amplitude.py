"""Draws the MSE over amplitude at one natural period, like figures 15-17 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from owtsweep.figures import curves, style
from owtsweep.studies.hub import published
from owtsweep.studies.hub.conditions import AMPLITUDE, NATURAL_PERIOD
from owtsweep.studies.hub.names import BASELINES

#: The panels: measure -> label of its axis.
PANELS = {"position": "position MSE, x + y (m²)", "velocity": "velocity MSE, vx + vy (m²/s²)"}
#: Published measure -> the measure to which it contributes.
PARTS = {"x": "position", "y": "position", "vx": "velocity", "vy": "velocity"}


def draw(
    summary: pd.DataFrame,
    natural_period: float,
    schemes: Sequence[str],
    *,
    window: str,
    tuning: str,
    coinciding: Sequence[Sequence[str]] = (),
    baselines: Sequence[str] = (),
) -> Figure:
    """Draw position and velocity MSE of schemes against the amplitude, on log-log axes.

    Published numbers at this natural period are drawn as hollow marks.

    Parameters
    ----------
    summary
        The table summary.csv of a run.
    natural_period
        One of the natural periods in `summary`, in s.
    schemes
        Schemes to draw, in the order of the legend.
    window
        The time window of the rows to draw, "full" or "settled"; also named in the title.
    tuning
        Name of the tuning, for the title.
    coinciding
        Groups of schemes with equal results, for the footnote.
    baselines
        Baselines to draw too, as thin lines.

    Raises
    ------
    InputError
        If `summary` has no data at that period in that window.
    """
    here = {NATURAL_PERIOD: natural_period}
    curves.choose(summary, schemes, window, here)  # baselines alone are no figure
    shown = curves.choose(summary, [*schemes, *baselines], window, here)
    printed = _choose_published(natural_period, shown["amplitude"], schemes)
    whole = printed.assign(measure=printed["measure"].map(PARTS), value=printed["published"])
    tables = sorted(set(printed["table"]))
    label = ""
    if tables:
        noun = "Tables" if len(tables) > 1 else "Table"
        label = f"hollow: published\n({noun} {', '.join(map(str, tables))})"
    return curves.draw(
        shown,
        schemes,
        AMPLITUDE,
        PANELS,
        title=f"Mean squared error over amplitude, natural period {natural_period:g} s\n"
        f"{style.describe_window(window)}, tuning: {tuning}",
        points=whole.groupby(["scheme", "measure", "amplitude"])["value"].sum().reset_index(),
        points_label=label,
        coinciding=coinciding,
        thin=baselines,
        notes=_explain_baselines(baselines)
        + [
            f"Table {row['table']}, {row['scheme']}: {row['note']}."
            for row in printed[printed["note"] != ""].to_dict("records")
        ],
    )


def _explain_baselines(baselines: Sequence[str]) -> list[str]:
    """Write a sentence for the footnote on the baselines that are drawn."""
    if not baselines:
        return []
    told = "; ".join(f"{name}, {BASELINES[name]}" for name in baselines)
    return [f"Thin: baselines ({told}). The axes have the range of the schemes."]


def _choose_published(
    natural_period: float, amplitudes: pd.Series[float], schemes: Sequence[str]
) -> pd.DataFrame:
    """Return the published numbers of the schemes at a natural period (s).

    Numbers at amplitudes outside the range of `amplitudes` are left out. The table is empty if the
    paper has none.
    """
    table = published.mse_tables()
    inside = table["amplitude"].between(amplitudes.min(), amplitudes.max())
    here = np.isclose(table["natural_period"], natural_period) & inside
    return table[here & table["scheme"].isin(list(schemes))]
