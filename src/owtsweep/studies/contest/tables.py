"""Makes the tables of a contest: summary and best schemes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK
from owtsweep.results.summary import summarise
from owtsweep.studies.contest.contest import WAIT, WINDOW, Contest

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd


def make_tables(contest: Contest, config: Any, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables "summary" and "best_scheme" from a run's rows."""
    cube = make_cube(contest, config, rows, list_competing(config, rows))
    measured = [name for name in contest.criteria if name in cube.measures]
    return {
        "summary": summarise(make_cube(contest, config, rows, config.schemes)),
        "best_scheme": find_best_schemes(cube, WINDOW, measured),
    }


def make_cube(contest: Contest, config: Any, rows: pd.DataFrame, schemes: Sequence[str]) -> Cube:
    """Arrange the rows of schemes as arrays over the axes of the map, measures and replicates."""
    return Cube.of_rows(
        rows,
        schemes,
        contest.find_conditions(config.axes),
        {axis: getattr(config.grid, axis) for axis in config.axes},
        measures=contest.list_measures(rows["measure"][rows["status"] == OK].unique()),
    )


def find_waits(rows: pd.DataFrame) -> dict[str, float]:
    """Return the schemes that wait for later measurements, each with how long it does, s."""
    waiting = rows[rows["measure"] == WAIT]
    return {
        str(name): float(of_scheme.max())
        for name, of_scheme in waiting.groupby("scheme", observed=True)["value"]
    }


def list_competing(config: Any, rows: pd.DataFrame) -> list[str]:
    """Return the schemes that do not wait; all of them if every one does."""
    waits = find_waits(rows)
    return [name for name in config.schemes if name not in waits] or config.schemes
