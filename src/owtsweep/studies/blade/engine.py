"""The engine of the blade study, from plan to figures."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from owtsweep.studies.blade import blocks
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.doubts import warn_of_doubts
from owtsweep.studies.contest import maps, tables, terminal

if TYPE_CHECKING:
    from owtsweep.studies.blade.config import BladeConfig


class BladeEngine:
    """The engine of the blade study (protocol `owtsweep.sweep.study.Engine`)."""

    samples = True
    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("scheme", "measure", "window"), str),
        **dict.fromkeys((*CONTEST.axes, "replicate", "value"), float),
    }
    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)
    tables = staticmethod(partial(tables.make_tables, CONTEST))
    drawings = staticmethod(partial(maps.list_maps, CONTEST))
    terminal = staticmethod(partial(terminal.show, CONTEST))

    def backend(self, config: BladeConfig) -> str:
        """Return "loky", joblib's backend for processes."""
        return "loky"

    def warm_up(self, config: BladeConfig, workers: int) -> None:
        """Warn of what a recorded lift makes doubtful."""
        warn_of_doubts(config)

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return [*CONTEST.axes, "scheme", "measure", "window", "replicate"]

    def overview(self, config: BladeConfig) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"
