"""Draws the figures of a study that is run by the expected engine, so without records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from owtsweep.figures.drawings import Drawing
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.studies.hub import describe
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import list_baselines, scheme_names
from owtsweep.studies.hub.describe import MEANING, describe_origin
from owtsweep.studies.hub.expected import answers, engine
from owtsweep.studies.hub.figures import listing
from owtsweep.studies.hub.measures import criteria
from owtsweep.studies.hub.schemes.skf import SCHEME
from owtsweep.studies.hub.worlds import AMPLITUDE, CONDITIONS, NATURAL_PERIOD

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

    same = _find_alike(config, rows, criteria(config))
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


def _find_alike(
    config: HubConfig, rows: pd.DataFrame, criteria: Sequence[str]
) -> list[tuple[str, ...]]:
    """Find groups of schemes with equal errors by all criteria, in the window that is judged."""
    judged = rows[rows["window"] == config.measures.window]
    return find_coinciding(describe.make_cube(config, judged), criteria)


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
    same = _find_alike(config, rows, (criterion,))
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
    schemes, baselines = (
        [name for name in each if name in done] for each in (names, list_baselines(config))
    )
    fine = engine.rows_of(config, [*schemes, *baselines], periods.tolist())
    places = {NATURAL_PERIOD.name: periods.tolist(), AMPLITUDE.name: amplitudes.tolist()}
    cube = Cube.of_rows(fine, [*schemes, *baselines], CONDITIONS, places)
    errors = answers.expect(cube, criterion, window)
    values, beside = errors[: len(schemes)], errors[len(schemes) :]
    amplitude = f"amplitude: {MEANING[config.normalise]} along the waves"
    axes = (NATURAL_PERIOD, replace(AMPLITUDE, label=amplitude))
    field = answers.make_field(axes, (periods, amplitudes), values, beside)
    won = [name for place, name in enumerate(baselines) if (field.baseline == place).any()]
    return smooth_map.draw(
        field,
        schemes,
        title=f"Best scheme by expected {criterion} MSE\n"
        f"{style.describe_window(window)}, tuning: {config.tuning_name}, no records",
        origin="All values are expectations over all records, computed from error spectra and "
        "noise without any record.",
        coinciding=same,
        baselines=baselines,
        notes=[*describe.explain(won), describe.tell_window(window)],
    )
