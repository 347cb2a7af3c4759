"""The engine of the studies that declare a contest: from plan to figures."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Generic

import pandas as pd

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.conditions import spread
from owtsweep.results.contents import Contents
from owtsweep.results.regret import Judged, make_regret
from owtsweep.results.status import FAILED
from owtsweep.studies.base import maps, tables
from owtsweep.studies.base.blocks import DeclaredBlocks, PlanPart
from owtsweep.studies.base.contest import WINDOW, AnyContest, C, Contest, describe_draws, predict
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.studies.base.looks import plan_look
from owtsweep.studies.base.tables import list_competing, make_cube
from owtsweep.sweep.study import Block, Engine, Look

if TYPE_CHECKING:
    from rich.console import RenderableType


#: Letters of the lines above a map that fit into an inch.
LETTERS_PER_INCH = 9.5


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
        cube = make_cube(self.contest, config, rows)
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
        """Return name -> function that draws: "map_<criterion>" of each criterion, "distributions".

        The latter shows single records, if there are several, by the key `criterion`.
        """
        from owtsweep.figures import best_scheme_map, distributions, regret_map

        contest = self.contest
        origin = (
            f"Truth: {contest.describe_truth(config)}; {describe_draws(config)}.\n"
            f"Sensors: {contest.describe_sensors(config)}."
        )
        save = partial(save_figure, metadata=metadata, origin=origin, letters=LETTERS_PER_INCH)
        cube = make_cube(contest, config, rows)
        conditions, records = contest.find_conditions(config), config.grid.describe_records()
        contenders = self.rank(config) if config.grid.decides else ()
        notes = [*maps.tell_unable(cube.unable), *maps.tell_latencies(config, rows)]
        failures = int(((rows["status"] == FAILED) & rows["scheme"].isin(list(cube.schemes))).sum())
        drawings = {
            f"map_{name}": save(
                partial(
                    best_scheme_map.draw, tables["best_scheme"], cube.schemes, conditions,
                    criterion=name, window=WINDOW, tuning=config.tuning_name,
                    quantity=criterion.title, coinciding=find_coinciding(cube, [name], contenders),
                    records=records, failures=failures, notes=notes,
                )
            )
            for name, criterion in contest.criteria.items()
            if name in set(tables["best_scheme"]["criterion"])
        }  # fmt: skip
        regret = regret_map.list_maps(tables, cube.schemes, conditions, config.tuning_name, records)
        drawings |= {name: save(draw) for name, draw in regret.items()}
        if config.grid.first >= distributions.LEAST_RECORDS:
            title = f"Errors of single records by {contest.criteria[config.criterion].title}"
            drawings[distributions.NAME] = save(
                partial(
                    distributions.draw, cube, config.criterion, WINDOW,
                    title=title, tuning=config.tuning_name, label="error",
                )
            )  # fmt: skip
        return drawings

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
        cubes = {world: make_cube(self.contest, config, part) for world, part in rows.items()}
        return make_regret(cubes, config.over or {}, judged, self.tell_worlds(config))
