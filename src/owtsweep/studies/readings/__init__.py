"""The calibration as a study: searches readings of the paper, and fair tunings, with Optuna."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from owtsweep.studies.hub.public import ROOMS
from owtsweep.sweep.study import Block, add_versions

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.figures.drawings import Drawing
    from owtsweep.results.conditions import Condition
    from owtsweep.studies.readings.config import ReadingsConfig

__all__ = ["ReadingsStudy"]


class ReadingsStudy:
    """The study of the search, and also its only engine. A block is a search with one seed."""

    name = "readings"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)
    samples = True

    def config_type(self) -> type[ReadingsConfig]:
        """The hub study's configuration and the section `calibration`."""
        from owtsweep.studies.readings.config import ReadingsConfig

        return ReadingsConfig

    def conditions(self, config: ReadingsConfig) -> tuple[Condition, ...]:
        """Empty, because a search has no grid of conditions."""
        return ()

    def engine(self, config: ReadingsConfig) -> ReadingsStudy:
        """The study itself, which is the only engine."""
        return self

    def plan(self, config: ReadingsConfig) -> list[Block]:
        """One block per search."""
        from owtsweep.studies.readings.searches import plan

        return plan(config)

    def backend(self, config: ReadingsConfig) -> str:
        """Processes, because a search runs Python code around kernels."""
        return "loky"

    def run(
        self, config: ReadingsConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run searches."""
        from owtsweep.studies.readings.searches import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        """The columns that identify a trial."""
        return ["target", "search", "trial"]

    def tables(self, config: ReadingsConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """The tables trials (all, in order of time) and best (of each search, best first)."""
        from owtsweep.studies.readings.results import rank_trials

        return {"trials": rows.reset_index(drop=True), "best": rank_trials(rows)}

    def terminal(
        self, config: ReadingsConfig, tables: Mapping[str, pd.DataFrame]
    ) -> RenderableType:
        """A table of the best trial of each search."""
        from owtsweep.studies.readings.results import render_best

        return render_best(tables["best"])

    def drawings(
        self,
        config: ReadingsConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """The scores of all trials: one figure per target, under one name."""
        from owtsweep.studies.readings.results import drawings

        return drawings(tables["trials"], metadata)

    def overview(self, config: ReadingsConfig) -> str:
        """The name of the figure of score over each parameter."""
        return "score_over_parameters"
