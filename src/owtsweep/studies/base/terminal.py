"""Shows a contest on the terminal: one map, who wins by each criterion, and who waits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from owtsweep.results.best_scheme import tell_winners
from owtsweep.studies.base.contest import WAIT, WINDOW, Contest
from owtsweep.studies.base.origin import describe_draws
from owtsweep.studies.base.schemes import list_names

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType


def show(contest: Contest, config: Any, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
    """Return the map by the key `criterion`, and who wins by each one."""
    from rich.console import Group
    from rich.text import Text

    from owtsweep.figures.terminal import grid

    best, summary = tables["best_scheme"], tables["summary"]
    origin = [
        f"Tuning {config.tuning_name}, {contest.describe_truth(config)}",
        f"Sensors: {contest.describe_sensors(config)}; {describe_draws(config)}",
    ]
    waiting = summary.loc[summary["measure"] == WAIT, "scheme"].unique()
    names = list_names(config.schemes)
    schemes = [name for name in names if name not in waiting] or names
    conditions = contest.find_conditions(config)
    shown = grid(best, schemes, conditions, config.criterion, WINDOW, score="error")
    told = [
        f"By {criterion.replace('_', ' ')}: {tell_winners(cells)}"
        for criterion in contest.criteria
        if len(cells := best[best["criterion"] == criterion])
    ]
    if len(schemes) < len(names):
        told.append(f"Not in the contest, because its estimates wait: {', '.join(waiting)}.")
    told += contest.tell_more(config, tables)
    return Group(
        *(Text(line, style="bold") for line in origin), shown, *(Text(line) for line in told)
    )
