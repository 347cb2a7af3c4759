"""The maps of the floater study: which scheme is best in which cell of the plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.status import FAILED
from owtsweep.studies.floater.conditions import find_conditions
from owtsweep.studies.floater.measures import CRITERIA, WINDOW
from owtsweep.studies.floater.origin import describe_draws, describe_sensors, describe_truth
from owtsweep.studies.floater.tables import find_waits, list_competing, make_cube

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from owtsweep.studies.floater.config import FloaterConfig


def list_maps(
    config: FloaterConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str],
) -> dict[str, Drawing]:
    """Return map_velocity, map_position and map_worst, each with its function."""
    cube = make_cube(config, rows, list_competing(config, rows))
    notes = [*tell_unable(cube.unable), *tell_waiting(config, rows)]
    failures = int(((rows["status"] == FAILED) & rows["scheme"].isin(list(cube.schemes))).sum())
    return {
        f"map_{criterion}": save_figure(
            partial(
                _draw, config, tables["best_scheme"], criterion, cube.schemes,
                find_coinciding(cube, [criterion]), failures, notes,
            ),
            metadata,
        )
        for criterion in CRITERIA
        if criterion in set(tables["best_scheme"]["criterion"])
    }  # fmt: skip


def tell_unable(unable: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that could not work; `unable` is that of a `Cube`."""
    if unable.empty:
        return []
    counts = unable["scheme"].astype(str).value_counts(sort=False)
    told = ", ".join(f"{name} in {n} cell{'s' * (n != 1)}" for name, n in counts.items())
    return [f"Unable to work, with its reason in summary.csv: {told}."]


def tell_waiting(config: FloaterConfig, rows: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that wait for later reports, if others do not."""
    waits = find_waits(rows)
    if not waits or list_competing(config, rows) == config.schemes:
        return []
    told = " and ".join(f"{name} ({wait:g} s)" for name, wait in waits.items())
    return [f"In summary.csv, but not in the contest, because estimates wait: {told}."]


def _draw(
    config: FloaterConfig,
    best: pd.DataFrame,
    criterion: str,
    schemes: Sequence[str],
    coinciding: list[tuple[str, ...]],
    failures: int,
    notes: Sequence[str],
) -> Figure:
    from owtsweep.figures import best_scheme_map, style

    figure = best_scheme_map.draw(
        best,
        schemes,
        find_conditions(config.axes),
        criterion=criterion,
        window=WINDOW,
        tuning=config.tuning_name,
        quantity=CRITERIA[criterion],
        score="error",
        coinciding=coinciding,
        replicates=config.grid.replicates,
        failures=failures,
        notes=notes,
    )
    lines = [
        f"Truth: {describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {describe_sensors(config)}.",
    ]
    style.add_origin(figure, "\n".join(lines))
    return figure
