"""The figures and tables of the hub study; one module each, matplotlib only once they are used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.sweep.study import FAILED

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from owtsweep.studies.hub.config import HubConfig


#: Natural periods (s) whose MSE over amplitude the paper shows, and the figure's number.
PAPER_FIGURES = {4.0: 15, 6.0: 16, 8.0: 17}
MAP = "figure_18_best_scheme"
#: Figures 9-14: name -> what of a time history they show, and whether zoomed in.
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
    """Every figure of a run by name, from its results and from its configuration.

    Parameters
    ----------
    tables
        summary and best_scheme.
    rows
        The run's cases, failed ones too.
    metadata
        Stored inside the figures.
    """
    from owtsweep.results.best_scheme import find_coinciding
    from owtsweep.studies.hub.conditions import CRITERIA, make_cube

    @cache
    def coinciding() -> list[tuple[str, ...]]:
        return find_coinciding(make_cube(config, rows), CRITERIA)

    of_results = _of_results(config, tables, rows, coinciding)
    return {
        **{name: save_figure(draw, metadata) for name, draw in of_results.items()},
        "tables_6_to_9": _published(config, tables["summary"]),
        **{
            name: save_figure(draw, metadata)
            for name, draw in _illustrations(config, coinciding).items()
        },
    }


def _of_results(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    coinciding: Callable[[], list[tuple[str, ...]]],
) -> dict[str, Callable[[], Figure]]:
    """Name -> what draws it from the run's results."""
    from owtsweep.figures import best_scheme_map
    from owtsweep.studies.hub import scheme_names
    from owtsweep.studies.hub.conditions import CONDITIONS
    from owtsweep.studies.hub.figures import mse_over_amplitude

    names = scheme_names(config)
    look: dict[str, Any] = {"window": config.measures.window, "tuning": config.tuning}
    failures = int((rows["status"] == FAILED).sum())

    def over_amplitude(period: float) -> Callable[[], Figure]:
        return lambda: mse_over_amplitude.draw(
            tables["summary"], period, names, coinciding=coinciding(), **look
        )

    def best(criterion: str) -> Callable[[], Figure]:
        return lambda: best_scheme_map.draw(
            tables["best_scheme"],
            names,
            CONDITIONS,
            criterion=criterion,
            quantity=f"{criterion} MSE (x + y)",
            coinciding=coinciding(),
            replicates=config.grid.replicates,
            failures=failures,
            **look,
        )

    figures = {MAP: best(config.measures.criterion), "best_scheme_velocity": best("velocity")}
    for period in sorted(set(tables["summary"].natural_period)):
        number = f"figure_{PAPER_FIGURES[period]}_" if period in PAPER_FIGURES else ""
        figures[f"{number}mse_{period:g}s"] = over_amplitude(period)
    return figures


def _published(config: HubConfig, summary: pd.DataFrame) -> Drawing:
    """Tables 6-9 as files."""
    from owtsweep.io.files import write_atomically
    from owtsweep.io.tables import write_table
    from owtsweep.studies.hub.figures.tables import tables_6_to_9, to_markdown

    def write(folder: Path, name: str) -> list[Path]:
        table = tables_6_to_9(summary, window=config.measures.window)
        text = folder / f"{name}.md"
        write_atomically(text, to_markdown(table))
        return [write_table(folder, name, table), text]

    return write


def _illustrations(
    config: HubConfig, coinciding: Callable[[], list[tuple[str, ...]]]
) -> dict[str, Callable[[], Figure]]:
    """Name -> what draws it from the configuration: a record, its spectrum, time histories."""
    from owtsweep.studies.hub.figures import error_spectra, record_and_spectrum, time_histories
    from owtsweep.studies.hub.histories import simulate_histories

    simulated = cache(lambda: simulate_histories(config))

    def history(quantity: str, *, zoom: bool) -> Callable[[], Figure]:
        return lambda: time_histories.draw(simulated(), quantity, zoom=zoom, tuning=config.tuning)

    return {
        "figure_03_record": lambda: record_and_spectrum.draw_record(config),
        "figure_04_spectrum": lambda: record_and_spectrum.draw_spectrum(config),
        **{name: history(quantity, zoom=zoom) for name, (quantity, zoom) in TIME_HISTORIES.items()},
        "error_spectra": lambda: error_spectra.draw(config, coinciding=coinciding()),
    }
