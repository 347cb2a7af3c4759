"""Recorded motion and recorded sensors through all schemes: which one for my turbine?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

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
    """The study of records, and also its only engine. A block is one record with one scheme."""

    name = "replay"
    schema_version = 1
    numerics_version = add_versions(1, *ROOMS)
    samples = True
    #: Columns without which no table can be made.
    row_types: ClassVar[Mapping[str, type]] = {
        **dict.fromkeys(("file", "scheme", "measure", "window"), str),
        **dict.fromkeys(("replicate", "value", "n_samples"), float),
    }

    def config_type(self) -> type[ReplayConfig]:
        """The hub study's configuration, with keys on how to read a record."""
        from owtsweep.studies.replay.config import ReplayConfig

        return ReplayConfig

    def conditions(self, config: ReplayConfig) -> tuple[Condition, ...]:
        """Empty, because a record has no grid of conditions."""
        return ()

    def engine(self, config: ReplayConfig) -> ReplayStudy:
        """The study itself, which is the only engine."""
        return self

    def plan(self, config: ReplayConfig) -> list[Block]:
        """One block for the record itself and one per scheme, for every file."""
        from owtsweep.studies.replay.blocks import plan

        return plan(config)

    def backend(self, config: ReplayConfig) -> str:
        """Threads for kernels; processes if a scheme is Python code."""
        from owtsweep.studies.hub.public import backend, resolve_all

        return backend(config, resolve_all(config.schemes, config))

    def run(
        self, config: ReplayConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one record."""
        from owtsweep.studies.replay.blocks import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        """The columns that identify a row."""
        return ["file", "scheme", "measure", "window", "replicate"]

    def tables(self, config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """The tables replay, errors, records and advice."""
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
        """The figures of a single record, or the map over many records."""
        from owtsweep.studies.replay.figures import drawings

        return drawings(config, tables, metadata)

    def overview(self, config: ReplayConfig) -> str:
        """The estimates over time, zoomed in; for many records, the map over them."""
        from owtsweep.studies.replay.figures import overview

        return overview(config)
