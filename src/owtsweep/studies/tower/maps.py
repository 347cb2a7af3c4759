"""The maps of the tower study: which scheme is best at which noise and soil factor."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.status import FAILED
from owtsweep.studies.contest.maps import tell_unable
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
    """Return map_damage, map_base_moment and map_displacement, each with its function."""
    cube = make_cube(config, rows)
    return {
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
    wrong = describe_errors(config)
    lines = [
        f"Truth: {describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {config.sensors.name}{f'; wrong: {wrong}' if wrong else ''}.",
    ]
    style.add_origin(figure, "\n".join(lines))
    return figure
