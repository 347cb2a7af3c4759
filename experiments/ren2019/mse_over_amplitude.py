"""Draw figures 15 to 17 of Ren et al. (2019) from a run, with the published numbers as marks."""

from __future__ import annotations

from typing import cast

import pandas as pd

from experiments.drawing import open_run
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.studies.hub.conditions import CRITERIA, make_cube
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.figures.listing import over_amplitude, save_each
from owtsweep.studies.hub.origin import describe_origin
from owtsweep.studies.readings.published import mse_tables

#: Published measure -> the measure to which it contributes.
PARTS = {"x": "position", "y": "position", "vx": "velocity", "vy": "velocity"}


def draw_mse(*periods: float) -> None:
    """Draw the MSE over amplitude at natural periods (s) into figures/; print the files."""
    run = open_run()
    for tuning, part in run.by_tuning().items():
        config = cast(HubConfig, part.config)
        same = find_coinciding(make_cube(config, part.cases()), CRITERIA)
        figures = over_amplitude(config, part.summary(), periods, same, printed=sum_printed())
        end = f"_{tuning}" if tuning else ""
        for name, draw in save_each(figures, describe_origin(config), part.metadata()).items():
            for file in draw(run.place / "figures", f"{name}{end}"):
                print(file)


def sum_printed() -> pd.DataFrame:
    """Return the published MSEs of position and velocity, as `mse_over_amplitude.draw` takes them.

    Columns: table, natural_period (s), amplitude (m), scheme, measure, value, note.
    """
    table = mse_tables()
    keys = ["table", "natural_period", "amplitude", "scheme"]
    whole = table.assign(measure=table["measure"].map(PARTS))
    sums = whole.groupby([*keys, "measure"], sort=False).agg(
        value=("published", "sum"), note=("note", lambda notes: "; ".join(filter(None, notes)))
    )
    return sums.reset_index()
