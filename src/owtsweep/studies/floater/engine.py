"""The engine of the floater study, from plan to figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from owtsweep.results.winners import tell_winners
from owtsweep.studies.floater import blocks
from owtsweep.studies.floater.conditions import find_conditions
from owtsweep.studies.floater.maps import list_maps
from owtsweep.studies.floater.measures import CRITERIA, WAIT, WINDOW
from owtsweep.studies.floater.origin import describe_draws, describe_sensors, describe_truth
from owtsweep.studies.floater.sections import AXES
from owtsweep.studies.floater.tables import make_tables

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.studies.floater.config import FloaterConfig


class FloaterEngine:
    """The engine of the floater study (protocol `owtsweep.sweep.study.Engine`)."""

    samples = True
    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("scheme", "measure", "window"), str),
        **dict.fromkeys((*AXES, "replicate", "value"), float),
    }
    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)
    tables = staticmethod(make_tables)
    drawings = staticmethod(list_maps)

    def backend(self, config: FloaterConfig) -> str:
        """Return "loky", joblib's backend for processes."""
        return "loky"

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return [*AXES, "scheme", "measure", "window", "replicate"]

    def terminal(self, config: FloaterConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the map by the key `criterion`, and who wins by each one."""
        from rich.console import Group
        from rich.text import Text

        from owtsweep.figures.terminal import grid

        best, summary = tables["best_scheme"], tables["summary"]
        origin = [
            f"Tuning {config.tuning_name}, {describe_truth(config)}",
            f"Sensors: {describe_sensors(config)}; {describe_draws(config)}",
        ]
        waiting = summary.loc[summary["measure"] == WAIT, "scheme"].unique()
        schemes = [name for name in config.schemes if name not in waiting] or config.schemes
        conditions = find_conditions(config.axes)
        shown = grid(best, schemes, conditions, config.criterion, WINDOW, score="error")
        told = [
            f"By {criterion}: {tell_winners(cells)}"
            for criterion in CRITERIA
            if len(cells := best[best["criterion"] == criterion])
        ]
        if len(schemes) < len(config.schemes):
            told.append(f"Not in the contest, because its estimates wait: {', '.join(waiting)}.")
        return Group(
            *(Text(line, style="bold") for line in origin), shown, *(Text(line) for line in told)
        )

    def overview(self, config: FloaterConfig) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"
