"""The maps of the tower study: which scheme is best at which noise and soil factor."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.status import FAILED
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.measures import CRITERIA, WINDOW
from owtsweep.studies.tower.origin import describe_draws, describe_errors, describe_truth
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
        notes=_tell_unable(unable),
    )
    wrong = describe_errors(config)
    lines = [
        f"Truth: {describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {config.sensors.name}{f'; wrong: {wrong}' if wrong else ''}.",
    ]
    style.add_origin(figure, "\n".join(lines))
    return figure


def _tell_unable(unable: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that could not work; `unable` is that of a `Cube`."""
    if unable.empty:
        return []
    counts = unable["scheme"].astype(str).value_counts(sort=False)
    told = ", ".join(f"{name} in {n} cell{'s' * (n != 1)}" for name, n in counts.items())
    return [f"Unable to work, with its reason in summary.csv: {told}."]
