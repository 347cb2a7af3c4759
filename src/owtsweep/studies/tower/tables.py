"""Makes the tables of the tower study: summary, best schemes, and welds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.results.summary import summarise
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.measures import CRITERIA, WINDOW, list_measures

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.tower.config import TowerConfig


def make_tables(config: TowerConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables "summary" and "best_scheme" from a run's rows."""
    cube = make_cube(config, rows)
    measured = [name for name in CRITERIA if name in cube.measures]
    return {
        "summary": summarise(cube),
        "best_scheme": find_best_schemes(cube, WINDOW, measured),
    }


def make_cube(config: TowerConfig, rows: pd.DataFrame) -> Cube:
    """Arrange a run's rows as arrays over schemes, conditions, measures and replicates."""
    spread = spread_soil(config, rows)
    return Cube.of_rows(
        spread,
        config.schemes,
        CONDITIONS,
        {"noise": config.grid.noise, "soil_factor": config.grid.soil_factor},
        measures=list_measures(spread["measure"][spread["status"] == OK].unique()),
    )


def spread_soil(config: TowerConfig, rows: pd.DataFrame) -> pd.DataFrame:
    """Repeat each row without a soil factor at every soil factor of the grid.

    Such a row is of a scheme whose model holds no soil: its estimates are the same for all.
    """
    import pandas as pd

    free = rows["soil_factor"].isna()
    factors = pd.DataFrame({"soil_factor": [float(f) for f in config.grid.soil_factor]})
    everywhere = rows[free].drop(columns="soil_factor").merge(factors, how="cross")
    return pd.concat([rows[~free], everywhere[rows.columns]], ignore_index=True)
