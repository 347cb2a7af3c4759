"""The figures and tables of the hub study; one module each, matplotlib only once they are used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.errors import InputError
from owtsweep.studies.base import FAILED

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.hub.config import HubConfig

#: Natural periods (s) whose MSE over amplitude the paper shows, and the figure's number.
PAPER_FIGURES = {4.0: 15, 6.0: 16, 8.0: 17}
MAP = "figure_18_best_scheme"


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

    Raises
    ------
    InputError
        If there is no figure of that name.
    """
    drawings = _drawings(config, tables, rows, metadata)
    if only is not None and only not in drawings:
        raise InputError(f"only: this run has no figure {only!r}; use {', '.join(drawings)}")
    files: list[Path] = []
    for name, draw in drawings.items():
        if only in (None, name):
            files += draw(folder, name)
    return files


def _drawings(
    config: HubConfig,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str] | None,
) -> dict[str, Callable[[Path, str], list[Path]]]:
    """Name -> what draws it into a folder."""
    from owtsweep.studies.hub import aggregate, scheme_names
    from owtsweep.studies.hub.figures import best_scheme_map, mse_over_amplitude, style
    from owtsweep.studies.hub.figures.tables import tables_6_to_9, to_markdown
    from owtsweep.sweep.files import write_atomically

    names = scheme_names(config)
    look: dict[str, Any] = {"window": config.measures.window, "tuning": config.tuning}
    values = aggregate.expand(rows, list(config.grid.amplitude))
    same = aggregate.coinciding(values, names)
    failures = int((rows["status"] == FAILED).sum())

    def mse(period: float) -> Callable[[Path, str], list[Path]]:
        def draw(folder: Path, name: str) -> list[Path]:
            with style.context():
                figure = mse_over_amplitude.draw(
                    tables["summary"], period, names, coinciding=same, **look
                )
                return style.save(figure, folder, name, metadata)

        return draw

    def best(criterion: str) -> Callable[[Path, str], list[Path]]:
        def draw(folder: Path, name: str) -> list[Path]:
            with style.context():
                figure = best_scheme_map.draw(
                    tables["best_scheme"],
                    names,
                    criterion=criterion,
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

    drawings: dict[str, Callable[[Path, str], list[Path]]] = {}
    drawings[MAP] = best(config.measures.criterion)
    drawings["best_scheme_velocity"] = best("velocity")
    for period in sorted(set(tables["summary"].natural_period)):
        number = f"figure_{PAPER_FIGURES[period]}_" if period in PAPER_FIGURES else ""
        drawings[f"{number}mse_{period:g}s"] = mse(period)
    drawings["tables_6_to_9"] = published
    return drawings
