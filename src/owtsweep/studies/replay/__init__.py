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
    """The study of recorded data, which is also its only engine; a block is a record and a scheme.

    A further block per record has no scheme: it describes the record itself.
    """

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
        """Return the configuration's type: the hub study's, with keys on how to read a record."""
        from owtsweep.studies.replay.config import ReplayConfig

        return ReplayConfig

    def conditions(self, config: ReplayConfig) -> tuple[Condition, ...]:
        """Return no conditions, because a record has no grid."""
        return ()

    def engine(self, config: ReplayConfig) -> ReplayStudy:
        """Return the study itself, which is the only engine."""
        return self

    def plan(self, config: ReplayConfig) -> list[Block]:
        """Return the blocks: for every file one for the record itself and one per scheme."""
        from owtsweep.studies.replay.blocks import plan

        return plan(config)

    def backend(self, config: ReplayConfig) -> str:
        """Return joblib's backend: threads for kernels, processes if a scheme is Python code."""
        from owtsweep.studies.hub.public import backend, resolve_all

        return backend(config, resolve_all(config.schemes, config))

    def run(
        self, config: ReplayConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run the blocks of one record; yield each block with its rows."""
        from owtsweep.studies.replay.blocks import run

        return run(config, blocks)

    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row."""
        return ["file", "scheme", "measure", "window", "replicate"]

    def tables(self, config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Make the tables replay, errors, records and advice, by name."""
        from owtsweep.studies.replay.results import aggregate

        return aggregate(config, rows)

    def terminal(self, config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Show the errors, if there is one record, and the advice."""
        from owtsweep.studies.replay.terminal import render_answer

        return render_answer(config, tables)

    def drawings(
        self,
        config: ReplayConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """List the figures by name: those of a single record, or the map over many records."""
        from owtsweep.studies.replay.figures import drawings

        return drawings(config, tables, metadata)

    def overview(self, config: ReplayConfig) -> str:
        """Return the name of the main figure: the position zoomed in, or the map over records."""
        from owtsweep.studies.replay.figures import overview

        return overview(config)
