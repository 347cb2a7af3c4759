"""Makes the tables of the floater study: summary and best schemes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.results.summary import summarise
from owtsweep.studies.floater.conditions import find_conditions
from owtsweep.studies.floater.measures import CRITERIA, WAIT, WINDOW, list_measures

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from owtsweep.studies.floater.config import FloaterConfig


def make_tables(config: FloaterConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables "summary" and "best_scheme" from a run's rows.

    Schemes that wait for later reports do not compete: an actuator cannot.
    """
    cube = make_cube(config, rows, list_competing(config, rows))
    measured = [name for name in CRITERIA if name in cube.measures]
    return {
        "summary": summarise(make_cube(config, rows, config.schemes)),
        "best_scheme": find_best_schemes(cube, WINDOW, measured),
    }


def make_cube(config: FloaterConfig, rows: pd.DataFrame, schemes: Sequence[str]) -> Cube:
    """Arrange the rows of schemes as arrays over the axes of the map, measures and replicates."""
    return Cube.of_rows(
        rows,
        schemes,
        find_conditions(config.axes),
        {axis: getattr(config.grid, axis) for axis in config.axes},
        measures=list_measures(rows["measure"][rows["status"] == OK].unique()),
    )


def find_waits(rows: pd.DataFrame) -> dict[str, float]:
    """Return the schemes that wait for later reports, each with how long it does, s."""
    waiting = rows[rows["measure"] == WAIT]
    return {
        str(name): float(of_scheme.max())
        for name, of_scheme in waiting.groupby("scheme", observed=True)["value"]
    }


def list_competing(config: FloaterConfig, rows: pd.DataFrame) -> list[str]:
    """Return the schemes that do not wait; all of them if every one does."""
    waits = find_waits(rows)
    return [name for name in config.schemes if name not in waits] or config.schemes
