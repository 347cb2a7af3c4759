"""The engine of the studies that declare a contest: from plan to figures."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Generic

import pandas as pd

from owtsweep.figures.drawings import Drawing
from owtsweep.results.conditions import spread
from owtsweep.results.contents import Contents
from owtsweep.results.regret import Judged, make_regret
from owtsweep.studies.base import maps, tables
from owtsweep.studies.base.blocks import DeclaredBlocks, PlanPart
from owtsweep.studies.base.contest import WINDOW, AnyContest, C, Contest, ContestConfig
from owtsweep.studies.base.costs import predict
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.studies.base.looks import plan_look
from owtsweep.studies.base.tables import list_competing, make_cube
from owtsweep.sweep.study import Block, Engine, Look

if TYPE_CHECKING:
    from rich.console import RenderableType


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

    @abstractmethod
    def plan(self, config: C, part: PlanPart | None = None) -> list[Block]:
        """Return all blocks of a configuration, or those of a part of its cells and schemes."""

    @abstractmethod
    def rank(self, config: C) -> Sequence[str]:
        """Return the names of a configuration's schemes, the simplest first."""

    def plan_look(self, config: C, rows: pd.DataFrame) -> Look | None:
        """Return the next look; None if all cells are decided or have most records."""
        if not config.grid.decides:
            return None
        rows = spread(rows, self.contest.get_grid(config))
        cube = tables.make_cube(self.contest, config, rows, tables.list_competing(config, rows))
        asked = tables.ask(self.contest, config, self.rank(config))
        cells = self.contest.list_cells(config)
        return plan_look(partial(self.plan, config), cells, cube, rows, asked)

    def tables(self, config: C, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        return tables.make_tables(self.contest, config, rows, self.rank(config))

    def drawings(
        self,
        config: C,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        """Return the map of each criterion, and the errors of single records."""
        contenders = self.rank(config) if config.grid.decides else ()
        return maps.list_maps(self.contest, config, tables, rows, metadata, contenders)

    def terminal(self, config: C, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the map by the key `criterion`, and who wins by each one."""
        return maps.show(self.contest, config, tables)

    def contents(
        self, config: C, tables: Mapping[str, pd.DataFrame], rows: pd.DataFrame
    ) -> Contents:
        names = list_competing(config, rows)
        criterion, every = config.criterion, self.contest.criteria
        measured = {name: each for name, each in every.items() if name in {*rows["measure"]}}
        return Contents(
            maps.list_origin_lines(self.contest, config),
            maps.tell(self.contest, config, tables),
            self.contest.find_conditions(config),
            {name: every[name] for name in (criterion, *measured)},
            WINDOW,
            [name for name in self.rank(config) if name in names],
            (),
            make_cube(self.contest, config, rows, names),
            tables["best_scheme"],
        )

    def predict(
        self, config: C, blocks: Sequence[Block], workers: int
    ) -> tuple[float, float] | None:
        """Return computing time (s) and memory (bytes) of blocks, from measured times."""
        costs = self.contest.costs
        return None if costs is None else predict(costs, blocks, config.record.steps, workers)

    def backend(self, config: C) -> str:
        return "loky"

    def sort_columns(self) -> list[str]:
        return [*self.contest.names, "scheme", "measure", "window", "replicate"]

    def overview(self, config: C) -> str:
        """Return the name of the map by the key `criterion`."""
        return f"map_{config.criterion}"


class DeclaredEngine(DeclaredBlocks, ContestEngine[ContestConfig]):
    """The only engine of a declared contest."""

    def __init__(self, declaration: AnyDeclaration, contest: AnyContest) -> None:
        DeclaredBlocks.__init__(self, declaration)
        ContestEngine.__init__(self, contest)

    def rank(self, config: ContestConfig) -> Sequence[str]:
        return [*self.declaration.schemes.rank(config)]

    def make_regret(
        self, config: ContestConfig, rows: Mapping[str, pd.DataFrame]
    ) -> dict[str, pd.DataFrame]:
        judged = Judged(config.criterion, self.contest.criteria[config.criterion], WINDOW)
        cubes = {
            world: make_cube(self.contest, config, part, list_competing(config, part))
            for world, part in rows.items()
        }
        return make_regret(cubes, config.over or {}, judged, self.tell_worlds(config))
