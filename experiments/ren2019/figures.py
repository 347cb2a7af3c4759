"""Figures of Ren et al. (2019), from a run; 15 to 17 with the published numbers as marks.

    python -m experiments.ren2019.figures [RUN] [FIGURE ...]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
FIGURE is figure_03, figure_04, figure_09 to figure_18; without any, all are drawn into the run's
folder figures/.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import cast

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.command import open_run
from experiments.ren2019.published import mse_tables
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import scheme_names
from owtsweep.studies.hub.describe import describe_origin, make_cube
from owtsweep.studies.hub.figures.listing import over_amplitude, save_each
from owtsweep.studies.hub.figures.mse_over_amplitude import PANELS
from owtsweep.studies.hub.measures import CRITERIA
from owtsweep.sweep.runs import Run

#: Figure -> its name among the figures of a run.
OF_RUN = {
    "figure_03": "figure_03_record", "figure_04": "figure_04_spectrum",
    "figure_09": "figure_09_position", "figure_10": "figure_10_position_zoom",
    "figure_11": "figure_11_velocity", "figure_12": "figure_12_velocity_zoom",
    "figure_13": "figure_13_acceleration", "figure_14": "figure_14_bias",
    "figure_18": "figure_18_best_scheme",
}  # fmt: skip
#: Figure of the MSE over amplitude -> its natural period, s.
PERIODS = {"figure_15": 4.0, "figure_16": 6.0, "figure_17": 8.0}
#: The style of published numbers, drawn beside the curves.
HOLLOW: style.Look = {
    "markerfacecolor": "none", "markersize": 10, "markeredgewidth": 1.6, "linestyle": "none",
}  # fmt: skip
#: Published measure -> the measure to which it contributes.
PARTS = {"x": "position", "y": "position", "vx": "velocity", "vy": "velocity"}


def draw_mse(run: Run, period: float) -> Iterator[Path]:
    """Draw the MSE over amplitude at a natural period (s) into figures/; yield the files."""
    for tuning, part in run.by_tuning().items():
        config = cast(HubConfig, part.config)
        same = find_coinciding(make_cube(config, part.cases()), CRITERIA)
        figures = {
            name: partial(add_printed, draw, scheme_names(config), period)
            for name, draw in over_amplitude(config, part.summary(), [period], same).items()
        }
        end = f"_{tuning}" if tuning else ""
        for name, draw in save_each(figures, describe_origin(config), part.metadata()).items():
            yield from draw(run.place / "figures", f"{name}{end}")


def add_printed(draw: Callable[[], Figure], schemes: Sequence[str], period: float) -> Figure:
    """Draw MSE over amplitude; published numbers at a natural period (s) are hollow marks."""
    figure, printed = draw(), sum_printed()
    amplitudes = figure.axes[0].get_lines()[0].get_xdata()
    inside = printed["amplitude"].between(min(amplitudes), max(amplitudes))
    inside &= np.isclose(printed["natural_period"], period)
    marks = printed[inside & printed["scheme"].isin(list(schemes))]
    if marks.empty:
        return figure
    for axes, measure in zip(figure.axes, PANELS, strict=True):
        low, high = axes.get_ylim()
        for name in schemes:
            rows = marks[(marks["scheme"] == name) & (marks["measure"] == measure)]
            look = style_of(name, schemes)
            axes.plot(
                rows["amplitude"], rows["value"], color=look.color, marker=look.marker, **HOLLOW
            )
        drawn = marks.loc[marks["measure"] == measure, "value"]
        axes.set_ylim(min(low, 0.8 * drawn.min()), max(high, 1.25 * drawn.max()))
    tables = sorted(set(marks["table"]))
    noun = "Tables" if len(tables) > 1 else "Table"
    label = f"hollow: published\n({noun} {', '.join(map(str, tables))})"
    (legend,) = figure.legends
    figure.legend(
        [*legend.legend_handles, Line2D([], [], color="0.3", marker="o", **HOLLOW)],
        [*(text.get_text() for text in legend.get_texts()), label],
        loc="outside right center", frameon=False,
    )  # fmt: skip
    legend.remove()
    notes = [
        f"Table {row['table']}, {row['scheme']}: {row['note']}."
        for row in marks[marks["note"] != ""].to_dict("records")
    ]
    style.footnote(figure, " ".join([*figure.get_supxlabel().splitlines(), *notes]))
    return figure


def sum_printed() -> pd.DataFrame:
    """Return the published MSEs of position and velocity.

    Columns: table, natural_period (s), amplitude (m), scheme, measure, value, note.
    """
    table = mse_tables()
    keys = ["table", "natural_period", "amplitude", "scheme"]
    whole = table.assign(measure=table["measure"].map(PARTS))
    sums = whole.groupby([*keys, "measure"], sort=False).agg(
        value=("published", "sum"), note=("note", lambda notes: "; ".join(filter(None, notes)))
    )
    return sums.reset_index()


if __name__ == "__main__":
    run = open_run()
    for name in sys.argv[2:] or sorted([*OF_RUN, *PERIODS]):
        drawn = draw_mse(run, PERIODS[name]) if name in PERIODS else run.draw(OF_RUN[name])
        print(*drawn, sep="\n")
