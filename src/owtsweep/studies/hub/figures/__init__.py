"""The figures and tables of the hub study; one module each, matplotlib only once they are used."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.figures.drawings import Drawing, draw_each
from owtsweep.sweep.study import FAILED

if TYPE_CHECKING:
    import pandas as pd

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


def draw_all(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    folder: Path,
    *,
    only: str | None = None,
    metadata: Mapping[str, str] | None = None,
) -> list[Path]:
    """Draw every figure of a run, or the one called `only`; returns the files.

    A figure that this run cannot have (no scheme of it settles, say) is left out with a logged
    warning, unless it is the one asked for.

    Raises
    ------
    InputError
        If there is no figure of that name, or the run cannot have it.
    """
    drawings = {
        **_drawings(config, tables, rows, metadata),
        **_illustrations(config, rows, metadata),
    }
    return draw_each(drawings, folder, only)


def _drawings(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str] | None,
) -> dict[str, Drawing]:
    """Name -> what draws it from the run's results."""
    from owtsweep.figures import best_scheme_map, style
    from owtsweep.io.files import write_atomically
    from owtsweep.results.best_scheme import find_coinciding
    from owtsweep.studies.hub import scheme_names
    from owtsweep.studies.hub.conditions import CONDITIONS, CRITERIA, make_cube
    from owtsweep.studies.hub.figures import mse_over_amplitude
    from owtsweep.studies.hub.figures.tables import tables_6_to_9, to_markdown

    names = scheme_names(config)
    look: dict[str, Any] = {"window": config.measures.window, "tuning": config.tuning}
    same = find_coinciding(make_cube(config, rows), CRITERIA)
    failures = int((rows["status"] == FAILED).sum())

    def mse(period: float) -> Drawing:
        def draw(folder: Path, name: str) -> list[Path]:
            with style.context():
                figure = mse_over_amplitude.draw(
                    tables["summary"], period, names, coinciding=same, **look
                )
                return style.save(figure, folder, name, metadata)

        return draw

    def best(criterion: str) -> Drawing:
        def draw(folder: Path, name: str) -> list[Path]:
            with style.context():
                figure = best_scheme_map.draw(
                    tables["best_scheme"],
                    names,
                    CONDITIONS,
                    criterion=criterion,
                    quantity=f"{criterion} MSE (x + y)",
                    coinciding=same,
                    replicates=config.grid.replicates,
                    failures=failures,
                    **look,
                )
                return style.save(figure, folder, name, metadata)

        return draw

    def published(folder: Path, name: str) -> list[Path]:
        table = tables_6_to_9(tables["summary"], window=config.measures.window)
        files = [folder / f"{name}.csv", folder / f"{name}.md"]
        write_atomically(files[0], table.to_csv(index=False, lineterminator="\n"))
        write_atomically(files[1], to_markdown(table))
        return files

    drawings: dict[str, Drawing] = {}
    drawings[MAP] = best(config.measures.criterion)
    drawings["best_scheme_velocity"] = best("velocity")
    for period in sorted(set(tables["summary"].natural_period)):
        number = f"figure_{PAPER_FIGURES[period]}_" if period in PAPER_FIGURES else ""
        drawings[f"{number}mse_{period:g}s"] = mse(period)
    drawings["tables_6_to_9"] = published
    return drawings


def _illustrations(
    config: HubConfig, rows: pd.DataFrame, metadata: Mapping[str, str] | None
) -> dict[str, Drawing]:
    """Name -> what draws it from the configuration: a record, its spectrum, time histories."""
    from owtsweep.figures import style
    from owtsweep.results.best_scheme import find_coinciding
    from owtsweep.studies.hub.conditions import CRITERIA, make_cube
    from owtsweep.studies.hub.figures import error_spectra, record_and_spectrum, time_histories
    from owtsweep.studies.hub.histories import histories

    simulated = cache(lambda: histories(config))

    def history(folder: Path, name: str) -> list[Path]:
        quantity, zoom = TIME_HISTORIES[name]
        figure = time_histories.draw(simulated(), quantity, zoom=zoom, tuning=config.tuning)
        return style.save(figure, folder, name, metadata)

    def record(folder: Path, name: str) -> list[Path]:
        return style.save(record_and_spectrum.draw_record(config), folder, name, metadata)

    def spectrum(folder: Path, name: str) -> list[Path]:
        return style.save(record_and_spectrum.draw_spectrum(config), folder, name, metadata)

    def errors(folder: Path, name: str) -> list[Path]:
        same = find_coinciding(make_cube(config, rows), CRITERIA)
        return style.save(error_spectra.draw(config, coinciding=same), folder, name, metadata)

    return {
        "figure_03_record": record,
        "figure_04_spectrum": spectrum,
        **dict.fromkeys(TIME_HISTORIES, history),
        "error_spectra": errors,
    }
