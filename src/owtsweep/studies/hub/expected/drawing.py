"""Draws the figures of a study that is run by the expected engine, so without records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from owtsweep.figures.drawings import Drawing
from owtsweep.results.status import OK
from owtsweep.studies.hub import describe
from owtsweep.studies.hub.conditions import criteria
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import MEANING, describe_origin
from owtsweep.studies.hub.expected import answers, engine
from owtsweep.studies.hub.figures import listing
from owtsweep.studies.hub.listed import list_baselines, scheme_names
from owtsweep.studies.hub.schemes.skf import SCHEME
from owtsweep.studies.hub.world import AMPLITUDE, NATURAL_PERIOD

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Number of points along each axis of a smooth map (picture of the best schemes).
FINE = 200
#: In grids of more natural periods than this, no figure per period is drawn.
MOST_PERIODS = 12


def drawings(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str] | None = None,
) -> dict[str, Drawing]:
    """Return figure name -> function that draws and saves the figure, for a study without records.

    The figures are the maps of the best schemes, MSE against amplitude, the error spectra and, if
    the configuration asks for it, the efficiency. In grids of more than `MOST_PERIODS` natural
    periods, MSE against amplitude is left out. `metadata` are texts to store inside the figures'
    files.
    """
    from owtsweep.studies.hub.figures import error_spectra

    same = answers.coinciding(rows, scheme_names(config), config.measures.window, criteria(config))
    periods = set(rows["natural_period"])
    if len(periods) > MOST_PERIODS:
        periods = set()
    drawn = {
        **listing.maps(config, partial(draw_map, config, tables, rows)),
        "error_spectra": lambda: error_spectra.draw(config, coinciding=same),
        **listing.over_amplitude(config, tables["summary"], periods, same),
        **listing.list_efficiency(config, tables["summary"]),
    }
    return listing.save_each(drawn, describe_origin(config), metadata)


def draw_map(
    config: HubConfig, tables: Mapping[str, pd.DataFrame], rows: pd.DataFrame, criterion: str
) -> Figure:
    """Draw the map of the best schemes by a criterion: amplitude against natural period.

    The map is smooth. Cells are drawn instead if the grid has only one period or amplitude, if the
    spectrum exists only at some periods, or if SKF takes part, whose errors are computed cell by
    cell.
    """
    from owtsweep.figures import smooth_map, style

    names, window, grid = scheme_names(config), config.measures.window, config.grid
    same = answers.coinciding(rows, names, window, (criterion,))
    smooth = (
        len(grid.natural_period) > 1
        and len(grid.amplitude) > 1
        and config.spectrum.kind == "translated"
        and SCHEME.name not in names
    )
    if not smooth:
        return listing.draw_cells(config, tables, rows, criterion, same)
    periods = np.linspace(min(grid.natural_period), max(grid.natural_period), FINE)
    amplitudes = np.geomspace(min(grid.amplitude), max(grid.amplitude), FINE)
    done = set(rows.loc[rows["status"] == OK, "scheme"])
    baselines = list_baselines(config)
    computed = [name for name in (*names, *baselines) if name in done]
    fine = engine.rows_of(config, computed, periods.tolist())
    expected = answers.expected(fine, names, criterion, window)
    values = expected.at(amplitudes)
    verdict = answers.judge(values)
    beside = answers.expected(fine, baselines, criterion, window)
    winning, lead = answers.find_winning(beside.at(amplitudes), verdict.mse_best)
    amplitude = f"amplitude: {MEANING[config.normalise]} along the waves"
    field = smooth_map.Field(
        across=NATURAL_PERIOD,
        upwards=replace(AMPLITUDE, label=amplitude),
        columns=periods,
        lines=amplitudes,
        values=values,
        best=np.where(winning >= 0, -1, verdict.best),
        excess=100.0 * (verdict.mse_runner_up / verdict.mse_best - 1.0),
        distinguishable=verdict.difference > answers.RESOLUTION * verdict.mse_best,
        resolution=answers.RESOLUTION,
        baseline=winning,
        lead=lead,
    )
    won = [name for place, name in enumerate(beside.schemes) if (winning == place).any()]
    return smooth_map.draw(
        field,
        expected.schemes,
        title=f"Best scheme by expected {criterion} MSE\n"
        f"{style.describe_window(window)}, tuning: {config.tuning_name}, no records",
        origin="All values are expectations over all records, computed from error spectra and "
        "noise without any record.",
        coinciding=same,
        baselines=beside.schemes,
        notes=[*describe.explain(won), describe.tell_window(window)],
    )
