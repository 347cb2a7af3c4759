"""The engine of the mating study, from plan to figures."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from owtsweep.studies.contest import maps, tables, terminal
from owtsweep.studies.mating import blocks
from owtsweep.studies.mating.contest import CONTEST

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.figures.drawings import Drawing
    from owtsweep.studies.mating.config import MatingConfig


class MatingEngine:
    """The engine of the mating study (protocol `owtsweep.sweep.study.Engine`)."""

    samples = True
    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("scheme", "measure", "window"), str),
        **dict.fromkeys((*CONTEST.axes, "replicate", "value"), float),
    }
    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)
    tables = staticmethod(partial(tables.make_tables, CONTEST))
    terminal = staticmethod(partial(terminal.show, CONTEST))

    def backend(self, config: MatingConfig) -> str:
        """Return "loky", joblib's backend for processes."""
        return "loky"

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return [*CONTEST.axes, "scheme", "measure", "window", "replicate"]

    def drawings(
        self,
        config: MatingConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        """Return the map of each criterion, and the map of chances."""
        from owtsweep.studies.mating.chances import list_figures

        return {
            **maps.list_maps(CONTEST, config, tables, rows, metadata),
            **list_figures(config, tables, metadata),
        }

    def overview(self, config: MatingConfig) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"
