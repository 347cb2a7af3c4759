"""Reads and draws a run: a folder with a configuration, cases and tables."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import Config, require
from owtsweep.errors import InputError, printable
from owtsweep.figures.drawings import draw_each
from owtsweep.io.tables import read_table
from owtsweep.sweep.gather import as_text, sort_rows
from owtsweep.sweep.keys import run_hash
from owtsweep.sweep.plan import Plan, make_plan
from owtsweep.sweep.rows import Setback, collect_setbacks
from owtsweep.sweep.schema import needed_columns
from owtsweep.sweep.store import Store
from owtsweep.sweep.study import OK, UNABLE, Engine, Study, blame

if TYPE_CHECKING:
    import pandas as pd

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Results:
    """The sorted rows of a run, and the tables that its study makes of them."""

    rows: pd.DataFrame
    tables: dict[str, pd.DataFrame]


@dataclass(frozen=True)
class Run:
    """A run, which may be finished, interrupted or still under way.

    Attributes
    ----------
    folder
        The run folder.
    config
        The resolved configuration, which says which cases belong to the run.
    study
        The study to which the configuration belongs.
    stored_plan
        The run's plan, if it has been made or read already; None if the folder holds no plan.
    """

    folder: Path
    config: Config
    study: Study
    stored_plan: Plan | None = None

    @property
    def hash(self) -> str:
        """The hash of the configuration without the keys that identify no run (`sweep.keys`)."""
        return run_hash(self.config)

    @property
    def store(self) -> Store:
        """The store of the run's shards."""
        with blame(self.study):
            return Store(self.folder, needed_columns(self.study, self.config))

    @property
    def engine(self) -> Engine:
        """The engine that plans, runs and draws this configuration."""
        return self.study.engine(self.config)

    def plan(self) -> Plan:
        """Return the blocks of the run by key: `stored_plan`, or a new plan if that is None.

        Raises
        ------
        InputError
            If `stored_plan` is None, and a new plan needs the code of a user's scheme, which is
            never imported when a run is read.
        """
        if self.stored_plan is None:
            return make_plan(self.study, self.config)
        return self.stored_plan

    def cases(self) -> pd.DataFrame:
        """Return the rows of all stored cases of the plan, including failed cases, sorted by case.

        Blocks that are missing are left out with a logged warning.

        Raises
        ------
        InputError
            If no case is stored.
        """
        return as_text(self._finished())

    def _finished(self) -> pd.DataFrame:
        rows, missing = self.stored()
        if rows is None:
            raise InputError(
                f"{self.folder}: all {missing} blocks are missing; run the sweep that makes them"
            )
        if missing:
            logger.warning(
                "%s: of the plan's blocks %d are missing; run its sweep again to compute them",
                self.folder,
                missing,
            )
        return rows

    def stored(self) -> tuple[pd.DataFrame | None, int]:
        """Return the rows of all stored cases, and the number of blocks that are missing.

        The rows are None if no case is stored. Only the shards of the plan are read, no other files
        in the folder. The rows are sorted, so that sums of rows do not depend on the order of the
        grid. Text columns are categorical, so that millions of rows fit into memory.
        """
        rows, missing = self.store.read_all(self.plan())
        if rows is not None:
            with blame(self.study):
                columns = self.engine.sort_columns()
            rows = sort_rows(rows, columns)
        return rows, len(missing)

    def unable(self) -> list[Setback]:
        """Return the stored cases that their scheme cannot compute, by block and reason.

        This reads all shards of the plan.
        """
        setbacks = []
        store = self.store
        for key, block in self.plan().items():
            if UNABLE in (store.statuses(key) or ()):
                rows = store.read(key)
                setbacks += [] if rows is None else collect_setbacks(block, rows, UNABLE)
        return setbacks

    def table(self, name: str) -> pd.DataFrame:
        """Read the table `<name>.csv` of the run.

        Raises
        ------
        InputError
            If the run has no table of this name, or the file is damaged.
        """
        return read_table(self.folder, name)

    def tables(self) -> dict[str, pd.DataFrame]:
        """Read all tables of the run; return them by name, or {} if no case has succeeded yet."""
        return {
            path.stem: read_table(self.folder, path.stem)
            for path in sorted(self.folder.glob("*.csv"))
        }

    def draw(self, only: str | None = None, results: Results | None = None) -> list[Path]:
        """Draw all figures of the run, or a single figure, into the folder `figures` of the run.

        Parameters
        ----------
        only
            The name of the single figure to draw; None draws all figures.
        results
            The results to draw, if they are in memory. If None, the shards are read.

        Returns
        -------
        list of Path
            The files of the figures. If the run cannot have a figure (e.g. because a scheme is
            missing), the figure is left out with a logged warning, unless `only` names it.

        Raises
        ------
        InputError
            If no case has succeeded, there is no figure named `only`, or the study comes from
            another package and does not work.
        OSError
            If the file system refuses a file; figures drawn earlier stay whole.
        """
        folder = self.folder / "figures"
        rows = results.rows if results else self._finished()
        require(
            bool((rows["status"] == OK).any()),
            f"{self.folder}: no case has succeeded, so there is nothing to draw; see its run.log",
        )
        # the tables are made of these rows, not read from files
        with blame(self.study):
            tables = results.tables if results else self.engine.tables(self.config, rows)
            drawings = self.engine.drawings(self.config, tables, rows, self.metadata())
        folder.mkdir(exist_ok=True)
        return draw_each(drawings, folder, only, partial(blame, self.study))

    def metadata(self) -> dict[str, str]:
        """Return what the files of the run's figures store: the hash and the folder's name."""
        return {"run": self.hash, "folder": printable(self.folder.name)}

    def summary(self) -> pd.DataFrame:
        """Read `summary.csv`: means of the replicates, with confidence intervals."""
        return self.table("summary")

    def best_scheme(self) -> pd.DataFrame:
        """Read `best_scheme.csv`: the best scheme in each cell of the grid."""
        return self.table("best_scheme")
