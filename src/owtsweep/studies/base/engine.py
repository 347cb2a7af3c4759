"""The engine of the studies that declare a contest: from plan to figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Generic

from owtsweep.config import AnyConfig
from owtsweep.studies.base import blocks, maps, tables
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.base.contest import AnyContest, C, Contest, ContestConfig
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.sweep.study import Engine

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.figures.drawings import Drawing
    from owtsweep.sweep.study import Block


class ContestEngine(Engine, Generic[C]):
    """What follows from a contest alone: tables, maps and the lines on the terminal."""

    samples = True

    def __init__(self, contest: Contest[C]) -> None:
        self.contest = contest
        #: Columns without which no table can be made.
        self.row_types: Mapping[str, type] = {
            **dict.fromkeys(("scheme", "measure", "window"), str),
            **dict.fromkeys((*contest.names, "replicate", "value"), float),
        }

    def tables(self, config: C, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        return tables.make_tables(self.contest, config, rows)

    def drawings(
        self,
        config: C,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        """Return the map of each criterion, and the errors of single records."""
        return maps.list_maps(self.contest, config, tables, rows, metadata)

    def terminal(self, config: C, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the map by the key `criterion`, and who wins by each one."""
        return maps.show(self.contest, config, tables)

    def backend(self, config: C) -> str:
        return "loky"

    def sort_columns(self) -> list[str]:
        return [*self.contest.names, "scheme", "measure", "window", "replicate"]

    def overview(self, config: C) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"


class DeclaredBlocks:
    """The part of an engine that follows from a declaration: plans and runs blocks."""

    def __init__(self, declaration: AnyDeclaration) -> None:
        self.declaration = declaration

    def plan(
        self,
        config: AnyConfig,
        cells: Sequence[Cell] | None = None,
        replicates: int | None = None,
    ) -> list[Block]:
        """Return all blocks of a configuration, or of some cells with another number of records."""
        return blocks.plan(self.declaration, config, cells, replicates)

    def run(
        self, config: AnyConfig, of_group: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yield each with its rows."""
        return blocks.run(self.declaration, config, of_group)

    def warm_up(self, config: AnyConfig) -> None:
        """Warn of what the configuration makes doubtful."""
        self.declaration.warn(config)


class DeclaredEngine(DeclaredBlocks, ContestEngine[ContestConfig]):
    """The only engine of a declared contest."""

    def __init__(self, declaration: AnyDeclaration, contest: AnyContest) -> None:
        DeclaredBlocks.__init__(self, declaration)
        ContestEngine.__init__(self, contest)
