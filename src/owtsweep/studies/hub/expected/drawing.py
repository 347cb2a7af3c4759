"""The figures of an expected study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.figures.drawings import Drawing
from owtsweep.results.status import FAILED, OK
from owtsweep.studies.hub.expected import answers, engine

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from owtsweep.studies.hub.config import HubConfig

#: Points of a smooth map along each axis.
FINE = 200
#: In grids of more periods no figure per period is drawn.
MOST_PERIODS = 12


def drawings(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str] | None = None,
) -> dict[str, Drawing]:
    """Name -> what draws it: the maps, MSE over amplitude and the error spectra."""
    from owtsweep.figures import style
    from owtsweep.studies.hub import criteria, scheme_names
    from owtsweep.studies.hub.figures import MAP, PAPER_FIGURES, error_spectra, mse_over_amplitude

    names = scheme_names(config)
    window = config.measures.window
    same = answers.coinciding(rows, names, window, criteria(config))

    def over_amplitude(period: float) -> Callable[[], Figure]:
        return lambda: mse_over_amplitude.draw(
            tables["summary"], period, names, window=window, tuning=config.tuning, coinciding=same
        )

    def saving(draw: Callable[[], Figure]) -> Drawing:
        def save(folder: Path, name: str) -> list[Path]:
            with style.context():
                return style.save(draw(), folder, name, metadata)

        return save

    figures: dict[str, Callable[[], Figure]] = {
        MAP: lambda: best(config, tables, rows, config.measures.criterion),
        "best_scheme_velocity": lambda: best(config, tables, rows, "velocity"),
        "error_spectra": lambda: error_spectra.draw(config, coinciding=same),
    }
    periods = sorted(set(rows["natural_period"]))
    for period in periods if len(periods) <= MOST_PERIODS else []:
        number = f"figure_{PAPER_FIGURES[period]}_" if period in PAPER_FIGURES else ""
        figures[f"{number}mse_{period:g}s"] = over_amplitude(period)
    return {name: saving(draw) for name, draw in figures.items()}


def best(
    config: HubConfig, tables: Mapping[str, pd.DataFrame], rows: pd.DataFrame, criterion: str
) -> Figure:
    """The smooth map over the grid's range; cells where the range is a point or has gaps."""
    from owtsweep.figures import best_scheme_map
    from owtsweep.studies.hub import scheme_names
    from owtsweep.studies.hub.conditions import CONDITIONS
    from owtsweep.studies.hub.figures import expected_map

    names = scheme_names(config)
    window, tuning = config.measures.window, config.tuning
    same = answers.coinciding(rows, names, window, (criterion,))
    grid = config.grid
    smooth = (
        len(grid.natural_period) > 1
        and len(grid.amplitude) > 1
        and config.spectrum.kind == "translated"
    )
    if not smooth:
        return best_scheme_map.draw(
            tables["best_scheme"], names, CONDITIONS, criterion=criterion, window=window,
            tuning=tuning, quantity=f"{criterion} MSE (x + y)", coinciding=same,
            failures=int((rows["status"] == FAILED).sum()),
        )  # fmt: skip
    periods = np.linspace(min(grid.natural_period), max(grid.natural_period), FINE)
    amplitudes = np.geomspace(min(grid.amplitude), max(grid.amplitude), FINE)
    finished = [name for name in names if ((rows["scheme"] == name) & (rows["status"] == OK)).any()]
    fine = engine.rows_of(config, finished, [float(p) for p in periods])
    expected = answers.expected(fine, names, criterion, window)
    return expected_map.draw(
        expected.at(amplitudes), expected.schemes, periods, amplitudes,
        criterion=criterion, window=window, tuning=tuning, normalise=config.normalise,
        coinciding=same,
    )  # fmt: skip
