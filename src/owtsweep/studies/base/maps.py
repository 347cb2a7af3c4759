"""The maps of a contest: which scheme is best in which cell of the plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from textwrap import fill
from typing import TYPE_CHECKING, Any

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.status import FAILED
from owtsweep.studies.base.contest import WINDOW, Contest
from owtsweep.studies.base.origin import describe_draws
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.base.tables import find_waits, list_competing, make_cube

#: Letters of the lines above a map that fit into an inch.
LETTERS_PER_INCH = 9.5

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from owtsweep.results.cube import Cube


def list_maps(
    contest: Contest,
    config: Any,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str],
) -> dict[str, Drawing]:
    """Return name -> function that draws: "map_<criterion>" of each criterion, "distributions".

    The latter shows the errors of single records by the key `criterion`, if there are several.
    """
    cube = make_cube(contest, config, rows, list_competing(config, rows))
    notes = [*tell_unable(cube.unable), *tell_waiting(config, rows)]
    failures = int(((rows["status"] == FAILED) & rows["scheme"].isin(list(cube.schemes))).sum())
    drawings = {
        f"map_{criterion}": save_figure(
            partial(
                _draw, contest, config, tables["best_scheme"], criterion, cube.schemes,
                find_coinciding(cube, [criterion]), failures, notes,
            ),
            metadata,
        )
        for criterion in contest.criteria
        if criterion in set(tables["best_scheme"]["criterion"])
    }  # fmt: skip
    origin = [
        f"Truth: {contest.describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {contest.describe_sensors(config)}.",
    ]
    return drawings | list_distributions(
        config, cube, WINDOW, contest.criteria[config.criterion], origin, metadata
    )


def list_distributions(
    config: Any,
    cube: Cube,
    window: str,
    quantity: str,
    origin: Sequence[str],
    metadata: Mapping[str, str],
) -> dict[str, Drawing]:
    """Return the figure of the errors of single records, if the run has several, by its name.

    Parameters
    ----------
    cube
        The errors of the schemes.
    window
        The part of the records over which they are averaged.
    quantity
        What the map says that schemes are judged by.
    origin
        Sentences on truth and sensors, for the title.
    """
    from owtsweep.figures import distributions, style

    if config.grid.replicates < distributions.LEAST_RECORDS:
        return {}

    def draw() -> Figure:
        figure = distributions.draw(
            distributions.collect(cube, config.criterion, window),
            cube.schemes,
            cube.conditions,
            title=f"Errors of single records by {quantity}\n"
            f"{style.describe_window(window)}, tuning: {config.tuning_name}",
            label="error",
        )
        letters = round(LETTERS_PER_INCH * figure.get_figwidth())
        style.add_origin(figure, "\n".join(fill(line, letters) for line in origin))
        return figure

    return {distributions.NAME: save_figure(draw, metadata)}


def tell_unable(unable: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that could not work; `unable` is that of a `Cube`."""
    if unable.empty:
        return []
    counts = unable["scheme"].astype(str).value_counts(sort=False)
    told = ", ".join(f"{name} in {n} cell{'s' * (n != 1)}" for name, n in counts.items())
    return [f"Unable to work, with its reason in summary.csv: {told}."]


def tell_waiting(config: Any, rows: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that wait for later measurements, if others do not."""
    waits = find_waits(rows)
    if not waits or list_competing(config, rows) == list_names(config.schemes):
        return []
    told = " and ".join(f"{name} ({wait:.3g} s)" for name, wait in waits.items())
    return [f"In summary.csv, but not in the contest, because estimates wait: {told}."]


def _draw(
    contest: Contest,
    config: Any,
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
        contest.find_conditions(config),
        criterion=criterion,
        window=WINDOW,
        tuning=config.tuning_name,
        quantity=contest.criteria[criterion],
        score="error",
        coinciding=coinciding,
        replicates=config.grid.replicates,
        failures=failures,
        notes=notes,
    )
    lines = [
        f"Truth: {contest.describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {contest.describe_sensors(config)}.",
    ]
    letters = round(LETTERS_PER_INCH * figure.get_figwidth())
    style.add_origin(figure, "\n".join(fill(line, letters) for line in lines))
    return figure
