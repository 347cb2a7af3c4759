"""Recorded motion and recorded sensors through all schemes: which one for my turbine?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.studies.replay.config import ReplayConfig

__all__ = ["ReplayStudy"]


class ReplayStudy:
    """`owtsweep.sweep.study.Study` for records; a block is one record with one scheme."""

    name = "replay"
    schema_version = 1
    numerics_version = 4

    def config_type(self) -> type[ReplayConfig]:
        """The hub study's configuration and how to read a record."""
        from owtsweep.studies.replay.config import ReplayConfig

        return ReplayConfig

    def plan(self, config: ReplayConfig) -> list[Block]:
        """The record's own block and one per scheme, for every file."""
        from owtsweep.studies.replay.blocks import plan

        return plan(config)

    def backend(self, config: ReplayConfig) -> str:
        """Threads for kernels; processes as soon as one scheme is Python."""
        from owtsweep.studies.hub.blocks import backend
        from owtsweep.studies.hub.schemes import resolve_all

        return backend(config, resolve_all(config.schemes, config))

    def run(
        self, config: ReplayConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one record."""
        from owtsweep.studies.replay.blocks import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        """What identifies a row."""
        return ["file", "scheme", "measure", "window", "replicate"]

    def aggregate(self, config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """replay, errors, records and advice."""
        from owtsweep.studies.replay.results import aggregate

        return aggregate(config, rows)

    def terminal(self, config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """The errors and the advice."""
        from owtsweep.studies.replay.terminal import answer

        return answer(config, tables)

    def overview(self) -> str:
        """The estimates in time, zoomed in; of many records, the map over them."""
        return "overview"

    def draw(
        self,
        config: ReplayConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        folder: Path,
        *,
        only: str | None = None,
        metadata: Mapping[str, str] | None = None,
    ) -> list[Path]:
        """Every record's figures, or the map over many records."""
        from owtsweep.figures.drawings import draw_each
        from owtsweep.studies.replay.figures import drawings, overview

        chosen = overview(config) if only == self.overview() else only
        return draw_each(drawings(config, tables, metadata), folder, chosen)
