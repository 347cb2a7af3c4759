"""The maps of the tower study: which scheme is best at which noise and soil factor."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.status import FAILED
from owtsweep.studies.contest.maps import list_distributions, tell_unable
from owtsweep.studies.contest.origin import describe_draws
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.measures import CRITERIA, WINDOW
from owtsweep.studies.tower.origin import describe_errors, describe_truth
from owtsweep.studies.tower.tables import make_cube

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from owtsweep.studies.tower.config import TowerConfig


def list_maps(
    config: TowerConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str],
) -> dict[str, Drawing]:
    """Return map_damage, map_base_moment, map_displacement and distributions with their functions.

    The last shows the errors of single records by the key `criterion`, if there are several.
    """
    cube = make_cube(config, rows)
    drawings = {
        f"map_{criterion}": save_figure(
            partial(
                _draw, config, tables["best_scheme"], criterion,
                find_coinciding(cube, [criterion]), int((rows["status"] == FAILED).sum()),
                cube.unable,
            ),
            metadata,
        )
        for criterion in CRITERIA
        if criterion in set(tables["best_scheme"]["criterion"])
    }  # fmt: skip
    return drawings | list_distributions(
        config, cube, WINDOW, CRITERIA[config.criterion], _describe_origin(config), metadata
    )


def _draw(
    config: TowerConfig,
    best: pd.DataFrame,
    criterion: str,
    coinciding: list[tuple[str, ...]],
    failures: int,
    unable: pd.DataFrame,
) -> Figure:
    from owtsweep.figures import best_scheme_map, style

    figure = best_scheme_map.draw(
        best,
        config.schemes,
        CONDITIONS,
        criterion=criterion,
        window=WINDOW,
        tuning=config.tuning_name,
        quantity=CRITERIA[criterion],
        score="error",
        coinciding=coinciding,
        replicates=config.grid.replicates,
        failures=failures,
        notes=tell_unable(unable),
    )
    style.add_origin(figure, "\n".join(_describe_origin(config)))
    return figure


def _describe_origin(config: TowerConfig) -> list[str]:
    wrong = describe_errors(config)
    return [
        f"Truth: {describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {config.sensors.name}{f'; wrong: {wrong}' if wrong else ''}.",
    ]
