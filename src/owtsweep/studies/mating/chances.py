"""Draws the map of chances: when root and hub can mate, and what each scheme makes of it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.conditions import show_value
from owtsweep.results.summary import summarise
from owtsweep.studies.base.contest import WAIT, describe_draws
from owtsweep.studies.base.tables import make_cube
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.mating.contest import CONTEST, describe_hold

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Measures of the panels of a scheme -> their titles. The truth has the first one alone.
PANELS = {"told": "said to be chances", "missed": "missed, of true", "false": "false, of said"}
#: Size of a cell in inches, and what labels around the panels take.
CELL, AROUND = (0.62, 0.34), (1.9, 1.9)


def list_figures(
    config: MatingConfig, rows: pd.DataFrame, metadata: Mapping[str, str]
) -> dict[str, Drawing]:
    """Return the figure "chances", with the function that draws it; none without any result."""
    summary = summarise(make_cube(CONTEST, config, rows, config.schemes), shared=True)
    if summary[summary["measure"] == "chance"].empty:
        return {}
    return {"chances": save_figure(partial(_draw, config, summary), metadata)}


def _draw(config: MatingConfig, summary: pd.DataFrame) -> Figure:
    import seaborn as sns  # takes a second to import

    from owtsweep.figures import style

    late = set(summary[summary["measure"] == WAIT]["scheme"])
    schemes = [name for name in config.schemes if name not in late]
    across, upwards = CONTEST.find_conditions(config)
    columns, rows = (sorted(getattr(config.grid, axis)) for axis in config.axes)
    figure = style.new_figure(
        len(PANELS) * (len(columns) * CELL[0] + 0.35) + AROUND[0],
        (len(schemes) + 1) * (len(rows) * CELL[1] + 0.35) + AROUND[1],
    )
    panels = figure.subplots(len(schemes) + 1, len(PANELS), squeeze=False)
    for (row, column), axes in np.ndenumerate(panels):
        if row == 0 and column > 0:
            axes.set_axis_off()
            continue
        measure = [*PANELS][column] if row > 0 else "chance"
        of_scheme = summary["scheme"] == schemes[max(row - 1, 0)]  # all have the same truth
        chosen = summary[of_scheme & (summary["measure"] == measure)]
        table = chosen.pivot(index=config.axes[1], columns=config.axes[0], values="mean")
        shares = 100.0 * table.reindex(index=rows, columns=columns).rename(show_value)
        sns.heatmap(
            shares.rename(columns=show_value), ax=axes, vmin=0.0, vmax=100.0, cbar=False,
            cmap="Greens" if measure in ("chance", "told") else "Reds", annot=True, fmt=".0f",
            annot_kws={"fontsize": 8},
        )  # fmt: skip
        axes.invert_yaxis()
        last = row in (0, len(schemes))
        axes.tick_params(length=0.0, labelbottom=last, labelleft=column == 0, labelrotation=0.0)
        axes.grid(visible=False)
        axes.set(xlabel="", ylabel="")
        axes.set_title(PANELS.get(measure, "chances"), fontsize=8)
        if column == 0:
            axes.set_ylabel(["truth", *schemes][row])
    figure.suptitle(
        "Chances to mate: shares of moments from which root and hub stay together for "
        f"{describe_hold(config)}, %",
        fontsize=10,
    )
    figure.supxlabel(across.title, fontsize=9)
    figure.supylabel(upwards.title, fontsize=9)
    lines = [
        "A blank cell has no chance, or none is said, so it has no share. Means are over the "
        "records that all schemes of a cell have.",
        f"Truth: {CONTEST.describe_truth(config)}; {describe_draws(config)}.",
        f"Sensors: {CONTEST.describe_sensors(config)}; tuning {config.tuning_name}.",
    ]
    style.add_origin(figure, "\n".join(lines), 12.0)
    return figure
