"""The engine of the study `readings`: make the tables of searches, and draw the trials' scores."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.config.section import unit_of
from owtsweep.figures.drawings import Drawing
from owtsweep.results.status import OK
from owtsweep.studies.hub.public import HubConfig
from owtsweep.studies.readings import searches
from owtsweep.sweep.study import Engine

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from owtsweep.studies.readings.config import ReadingsConfig

#: Number of trials of each search in the table `best`.
KEPT = 5


class SearchEngine(Engine):
    """The engine of the study `readings`; a row of its results is one trial of a search."""

    samples = True
    #: Columns without which no table can be made.
    row_types: Mapping[str, type] = {
        **dict.fromkeys(("target", "truth", "search"), str),
        **dict.fromkeys(("trial", "score"), float),
    }
    plan = staticmethod(searches.plan)
    run = staticmethod(searches.run)

    def backend(self, config: ReadingsConfig) -> str:
        """Return "loky", joblib's backend for processes, because a search runs much Python code."""
        return "loky"

    def sort_columns(self) -> list[str]:
        """Return the names of the columns that together identify a trial."""
        return ["target", "search", "trial"]

    def tables(self, config: ReadingsConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Make the tables "trials" (all rows) and "best" (the best trials of each search)."""
        return {"trials": rows.reset_index(drop=True), "best": rank_trials(rows)}

    def terminal(
        self, config: ReadingsConfig, tables: Mapping[str, pd.DataFrame]
    ) -> RenderableType:
        """Make the terminal's table: the best trial of each target, and its parameters' values."""
        from rich.table import Table

        best = tables["best"]
        shown = Table(title="best readings found", show_lines=True)
        for column in ("target", "truth", "score", "parameters"):
            shown.add_column(column)
        for target, group in best.groupby("target", sort=True):
            row = group.iloc[0]
            values = {name: row[name] for name in list_parameters(best) if pd.notna(row[name])}
            text = "\n".join(f"{name} = {_format(value)}" for name, value in values.items())
            shown.add_row(str(target), str(row.truth), f"{row.score:.4g}", text)
        return shown

    def drawings(
        self,
        config: ReadingsConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """Return the figure "score_over_parameters": scores against each parameter, per target."""

        def draw(folder: Path, name: str) -> list[Path]:
            from owtsweep.figures import style

            files: list[Path] = []
            trials = tables["trials"]
            for target, group in trials[trials.status == OK].groupby("target", sort=True):
                with style.context():
                    figure = _score_over_parameters(str(target), group)
                    files += style.save(figure, folder, f"{name}_{target}", metadata)
            return files

        return {"score_over_parameters": draw}

    def overview(self, config: ReadingsConfig) -> str:
        """Return the name of the main figure, which shows the score against each parameter."""
        return "score_over_parameters"


def rank_trials(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the `KEPT` best successful trials of each search, best first, sorted by target."""
    done = rows[rows.status == OK]
    ranked = done.sort_values(["target", "score", "search", "trial"], kind="stable")
    return ranked.groupby("search", sort=False).head(KEPT).reset_index(drop=True)


def list_parameters(table: pd.DataFrame) -> list[str]:
    """Return the names of the columns of a table of trials that hold the values of parameters."""
    return [column for column in table.columns if column not in searches.COLUMNS]


def _format(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _score_over_parameters(target: str, table: pd.DataFrame) -> Figure:
    from owtsweep.figures import style

    names = [name for name in list_parameters(table) if table[name].notna().any()]
    columns = min(4, max(1, len(names)))
    lines = -(-len(names) // columns)
    figure = style.new_figure(3.1 * columns, 2.5 * lines + 0.9)
    axes = figure.subplots(lines, columns, sharey=True, squeeze=False)
    lowest = table.score.min()
    for panel, name in zip(axes.flat, names, strict=False):
        for truth, group in table.groupby("truth", sort=True):
            panel.plot(group[name], group.score, ".", markersize=4, alpha=0.6, label=str(truth))
        winner = table.nsmallest(1, "score")
        numeric = pd.api.types.is_float_dtype(table[name])
        panel.plot(winner[name], winner.score, "k*", markersize=10, label="best")
        lowest_value, highest_value = table[name].agg(["min", "max"]) if numeric else (0.0, 0.0)
        if 0.0 < 20.0 * lowest_value < highest_value:
            panel.set_xscale("log")
            panel.xaxis.set_minor_formatter("")  # labels between powers of ten would overlap
        elif numeric:
            panel.locator_params(axis="x", nbins=5)
        unit = unit_of(HubConfig, name.split("+")[0])
        panel.set_xlabel(name.replace("+", " +\n") + (f" ({unit})" if unit else ""), fontsize=7)
        panel.set_ylim(lowest * 0.95, min(table.score.quantile(0.9), lowest * 4.0) * 1.02)
    for panel in list(axes.flat)[len(names) :]:
        panel.set_axis_off()
    for line in axes:
        line[0].set_ylabel("score (less is better)")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=4)
    figure.suptitle(f"{target}: every trial, by parameter", x=0.01, ha="left")
    style.footnote(
        figure,
        "Each dot is a trial. Trials above the panel's edge are not shown; trials.csv has all.",
    )
    return figure
