"""The engine of the tower study, from plan to figures."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from owtsweep.results.best_scheme import tell_winners
from owtsweep.studies.contest.origin import describe_draws
from owtsweep.studies.tower import blocks
from owtsweep.studies.tower.checks import warn_of_few_inclinometers
from owtsweep.studies.tower.conditions import CONDITIONS
from owtsweep.studies.tower.maps import list_maps
from owtsweep.studies.tower.measures import CRITERIA, WINDOW
from owtsweep.studies.tower.origin import describe_errors, describe_noise, describe_truth
from owtsweep.studies.tower.sight import describe_sight
from owtsweep.studies.tower.tables import make_tables

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.studies.tower.config import TowerConfig

logger = logging.getLogger(__name__)


class TowerEngine:
    """The engine of the tower study (protocol `owtsweep.sweep.study.Engine`)."""

    samples = True
    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("scheme", "measure", "window"), str),
        **dict.fromkeys(("noise", "soil_factor", "replicate", "value"), float),
    }
    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)
    tables = staticmethod(make_tables)
    drawings = staticmethod(list_maps)

    def backend(self, config: TowerConfig) -> str:
        """Return "loky", joblib's backend for processes: rainflow counting runs Python code."""
        return "loky"

    def warm_up(self, config: TowerConfig, workers: int) -> None:
        """Log what the set-up sees, and a warning if it has few inclinometers."""
        for line in describe_sight(config):
            logger.info("%s", line)
        warn_of_few_inclinometers(config)

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return ["noise", "soil_factor", "scheme", "measure", "window", "replicate"]

    def terminal(self, config: TowerConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the map by the key `criterion`, all winners, the noise, and what is seen."""
        from rich.console import Group
        from rich.text import Text

        from owtsweep.figures.terminal import grid

        best = tables["best_scheme"]
        wrong = describe_errors(config)
        origin = [
            f"Tuning {config.tuning_name}, sensors {config.sensors.name}",
            describe_truth(config),
            *([f"wrong: {wrong}"] if wrong else []),
            describe_draws(config),
        ]
        shown = grid(best, config.schemes, CONDITIONS, config.criterion, WINDOW, score="error")
        told = [
            Text(f"By {criterion.replace('_', ' ')}: {tell_winners(cells)}")
            for criterion in CRITERIA
            if len(cells := best[best["criterion"] == criterion])
        ]
        seen = [
            Text(line)
            for line in (*describe_noise(config, tables["summary"]), *describe_sight(config))
        ]
        return Group(*(Text(line, style="bold") for line in origin), shown, *told, *seen)

    def overview(self, config: TowerConfig) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"
