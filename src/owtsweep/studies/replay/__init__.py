"""Recorded motion and recorded sensors through all schemes: which one for my turbine?"""

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
    from owtsweep.studies.replay.config import ReplayConfig

__all__ = ["ReplayStudy"]


class ReplayStudy:
    """The study of records, and its only engine; a block is one record with one scheme."""

    name = "replay"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)
    samples = True

    def config_type(self) -> type[ReplayConfig]:
        """The hub study's configuration and how to read a record."""
        from owtsweep.studies.replay.config import ReplayConfig

        return ReplayConfig

    def conditions(self, config: ReplayConfig) -> tuple[Condition, ...]:
        """A record has no grid: it is what it is."""
        return ()

    def engine(self, config: ReplayConfig) -> ReplayStudy:
        """There is one engine, and it is the study itself."""
        return self

    def plan(self, config: ReplayConfig) -> list[Block]:
        """The record's own block and one per scheme, for every file."""
        from owtsweep.studies.replay.blocks import plan

        return plan(config)

    def backend(self, config: ReplayConfig) -> str:
        """Threads for kernels; processes as soon as one scheme is Python."""
        from owtsweep.studies.hub.public import backend, resolve_all

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

    def tables(self, config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """replay, errors, records and advice."""
        from owtsweep.studies.replay.results import aggregate

        return aggregate(config, rows)

    def terminal(self, config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """The errors and the advice."""
        from owtsweep.studies.replay.terminal import render_answer

        return render_answer(config, tables)

    def drawings(
        self,
        config: ReplayConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """A single record's figures, or the map over many records."""
        from owtsweep.studies.replay.figures import drawings

        return drawings(config, tables, metadata)

    def overview(self, config: ReplayConfig) -> str:
        """The estimates in time, zoomed in; of many records, the map over them."""
        from owtsweep.studies.replay.figures import overview

        return overview(config)
