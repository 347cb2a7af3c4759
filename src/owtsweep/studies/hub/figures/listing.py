"""The figures and tables of the hub study; matplotlib is imported only when a figure is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.figures import regret_map
from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.conditions import Value, select
from owtsweep.results.status import FAILED
from owtsweep.results.summary import summarise
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import list_baselines, scheme_names
from owtsweep.studies.hub.describe import (
    describe_origin,
    find_alike,
    find_winners,
    judge_efficiency,
    make_cube,
    tell_window,
)
from owtsweep.studies.hub.measures import JUDGED
from owtsweep.studies.hub.worlds import find_world, list_maps

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: A function that draws a figure.
Draw = Callable[[], "Figure"]

#: Natural periods (s) whose MSE over amplitude the paper shows, and how the figure's name begins.
PAPER_FIGURES = {4.0: "figure_15_", 6.0: "figure_16_", 8.0: "figure_17_"}
MAP = "figure_18_best_scheme"
#: Figures that do not depend on the tuning.
UNTUNED = frozenset({"figure_03_record", "figure_04_spectrum"})
#: The paper's figures 9-14: name -> quantity shown over time, and whether the figure is zoomed in.
TIME_HISTORIES = {
    "figure_09_position": ("position", False),
    "figure_10_position_zoom": ("position", True),
    "figure_11_velocity": ("velocity", False),
    "figure_12_velocity_zoom": ("velocity", True),
    "figure_13_acceleration": ("acceleration", True),
    "figure_14_bias": ("bias", False),
}


def drawings(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str] | None = None,
) -> dict[str, Drawing]:
    """List all figures of a run with records: name -> function that draws and saves the figure.

    Some show the run's results, in maps for all conditions off their axes. The others are simulated
    from its configuration.

    rows: the run's rows, including those of failed schemes.
    metadata: texts by name to store inside the figures' files.
    """
    records, same = config.grid.describe_records(), find_alike(config, rows)
    found: dict[str, Draw] = {}
    for end, at in list_maps(config).items():
        best = partial(draw_cells, config, tables, rows, coinciding=same, records=records, at=at)
        found |= {f"{name}{end}": draw for name, draw in maps(config, best).items()}
    world = find_world(config)
    if world.has_spectrum:
        summary = tables["summary"]
        if config.grid.decides:  # over the records alone that all schemes of a cell have
            shared = summarise(make_cube(config, rows, baselines=True), shared=True)
            summary = judge_efficiency(shared, config)
        found |= over_amplitude(config, summary, set(summary["natural_period"]), same)
        found |= {**list_efficiency(config, summary), **list_distributions(config, rows)}
    names, axes = scheme_names(config) + list_baselines(config), world.find_conditions(config)
    found |= regret_map.list_maps(tables, names, axes, config.tuning_name, records)
    return {
        **save_each(found, describe_origin(config), metadata),
        **save_each(
            _illustrations(config, same), describe_origin(config, f"seed {config.seed}"), metadata
        ),
    }


def save_each(
    figures: Mapping[str, Draw], origin: str, metadata: Mapping[str, str] | None
) -> dict[str, Drawing]:
    """Turn functions that draw figures into functions that save them too, with `origin` above."""
    return {name: save_figure(draw, metadata, origin) for name, draw in figures.items()}


def maps(config: HubConfig, draw_map: Callable[[str], Figure]) -> dict[str, Draw]:
    """List by name the maps of the best scheme by the run's criterion and by velocity."""
    return {
        MAP: partial(draw_map, config.measures.criterion),
        "best_scheme_velocity": partial(draw_map, "velocity"),
    }


def draw_cells(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    criterion: str,
    coinciding: Sequence[Sequence[str]],
    *,
    records: str = "",
    at: Mapping[str, Value] | None = None,
) -> Figure:
    """Draw the map of the best schemes with one coloured cell per natural period and amplitude.

    With motion=plant, the axes are two of the plant's conditions.

    rows: the run's rows, of which failed ones are counted.
    coinciding: groups of schemes with equal results, shown under the last of their names.
    records: how many records a cell has, for the title.
    at: values of the conditions that are not axes of the map.
    """
    from owtsweep.figures import best_scheme_map

    window, judged = config.measures.window, JUDGED[criterion]
    best, names, notes = find_winners(config, tables["best_scheme"], criterion, window)
    values = f", {find_world(config).describe_values(at)}" if at else ""
    return best_scheme_map.draw(
        select(best, at or {}),
        names,
        find_world(config).find_conditions(config)[:2],
        criterion=criterion,
        window=window,
        tuning=config.tuning_name,
        quantity=f"{judged.title} ({judged.unit}){values}",
        coinciding=coinciding,
        records=records,
        failures=int((rows["status"] == FAILED).sum()),
        notes=[*notes, tell_window(window, config.measures.settling_time)],
    )


def over_amplitude(
    config: HubConfig,
    summary: pd.DataFrame,
    periods: Iterable[float],
    coinciding: Sequence[Sequence[str]],
) -> dict[str, Draw]:
    """List the figures of MSE against amplitude by name, one figure per natural period (s)."""
    from owtsweep.studies.hub.figures import mse_over_amplitude

    draw = partial(mse_over_amplitude.draw, config, summary, coinciding=coinciding)
    return {
        f"{PAPER_FIGURES.get(period, '')}mse_{period:g}s": partial(draw, period)
        for period in sorted(periods)
    }


def list_efficiency(config: HubConfig, summary: pd.DataFrame) -> dict[str, Draw]:
    """List the figure of efficiency, if the configuration asks for it, by its name."""
    if not config.measures.efficiency:
        return {}
    from owtsweep.studies.hub.figures import efficiency

    return {efficiency.NAME: partial(efficiency.draw, config, summary)}


def list_distributions(config: HubConfig, rows: pd.DataFrame) -> dict[str, Draw]:
    """List the figure of the errors of single records, if there are several, by its name."""
    from owtsweep.figures import distributions
    from owtsweep.studies.hub.figures.mse_over_amplitude import PANELS

    criterion = config.measures.criterion
    if config.grid.first < distributions.LEAST_RECORDS:
        return {}

    def draw() -> Figure:
        return distributions.draw(
            make_cube(config, rows, baselines=True),
            criterion,
            config.measures.window,
            title=f"Errors of single records, {criterion} MSE",
            tuning=config.tuning_name,
            label=PANELS.get(criterion, f"position MSE, {criterion} (m²)"),
        )

    return {distributions.NAME: draw}


def _illustrations(config: HubConfig, coinciding: Sequence[Sequence[str]]) -> dict[str, Draw]:
    """List the figures that need the configuration alone: record, spectrum, histories, errors."""
    from owtsweep.studies.hub.figures import error_spectra, record_and_spectrum, time_histories
    from owtsweep.studies.hub.histories import simulate_histories

    simulated = cache(lambda: simulate_histories(config))

    def history(quantity: str, zoom: bool) -> Figure:
        return time_histories.draw(simulated(), quantity, zoom=zoom, tuning=config.tuning_name)

    found: dict[str, Draw] = {
        "figure_03_record": partial(record_and_spectrum.draw_record, config),
        "figure_04_spectrum": partial(record_and_spectrum.draw_spectrum, config),
        **{name: partial(history, *shown) for name, shown in TIME_HISTORIES.items()},
    }
    if find_world(config).has_spectrum:
        found["error_spectra"] = partial(error_spectra.draw, config, coinciding=coinciding)
    return found
