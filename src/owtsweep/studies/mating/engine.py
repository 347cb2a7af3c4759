"""The engine of the mating study, from plan to figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from owtsweep.studies.base.engine import ContestEngine
from owtsweep.studies.mating import blocks
from owtsweep.studies.mating.contest import CONTEST

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.figures.drawings import Drawing
    from owtsweep.studies.mating.config import MatingConfig


class MatingEngine(ContestEngine["MatingConfig"]):
    """The engine of the mating study (protocol `owtsweep.sweep.study.Engine`)."""

    plan = staticmethod(blocks.plan)
    run = staticmethod(blocks.run)

    def __init__(self) -> None:
        super().__init__(CONTEST)

    def drawings(
        self,
        config: MatingConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        """Return the map of each criterion, and the map of chances."""
        from owtsweep.studies.mating.chances import list_figures

        figures = super().drawings(config, tables, rows, metadata)
        return {**figures, **list_figures(config, tables, metadata)}
