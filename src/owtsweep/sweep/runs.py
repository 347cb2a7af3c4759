"""Reads and draws a run: a folder with a configuration, cases and tables."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import Config, require
from owtsweep.config.over import NOMINAL, Over, name_worlds
from owtsweep.errors import InputError, printable
from owtsweep.figures.drawings import Drawing, draw_each
from owtsweep.io.files import write_atomically
from owtsweep.io.tables import read_table
from owtsweep.sweep import asked
from owtsweep.sweep.gather import Results, join_rows, sort_rows
from owtsweep.sweep.keys import question_hash, run_folder, run_hash
from owtsweep.sweep.plan import Plan, count_cases, make_plan
from owtsweep.sweep.rows import Setback, collect_setbacks, needed_columns
from owtsweep.sweep.store import Store
from owtsweep.sweep.study import OK, UNABLE, Engine, Study, blame

if TYPE_CHECKING:
    import pandas as pd
    import xarray

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Run:
    """A run, which may be finished, interrupted or still under way.

    folder: the run folder, or the folder of one of its questions (`owtsweep.sweep.asked`).
    config: the resolved configuration, which says which cases belong to the run.
    study: the study to which the configuration belongs.
    stored_plan: the run's plan (key -> block) as read from the folder or made before. If None,
        `plan` makes a new plan.
    question: the hash of what was asked; "" if that is not known.
    home: the run folder, if `folder` is that of a question; otherwise None.
    tuning: the tuning, if this is the part of a run with several tunings that `by_tuning` returns;
        otherwise "".

    >>> import owtsweep
    >>> run = owtsweep.run([
    ...     "grid.natural_period=[4]", "grid.amplitude=[0.2,1]", "grid.replicates=2",
    ...     "record.duration=60", "schemes=[MKF,HME1]", "name=shown",
    ... ])
    >>> sorted(run.tables())
    ['best_scheme', 'ratios', 'summary']
    >>> best = run.best_scheme()
    >>> best[best["criterion"] == "position"].set_index("amplitude")["best"].to_dict()
    {0.2: 'HME1', 1.0: 'HME1'}
    >>> bool((run.summary()["n"] == 2).all()), set(run.cases()["status"])
    (True, {'ok'})
    >>> run.table("ratios").columns[:2].tolist()
    ['natural_period', 'amplitude']
    >>> list(run.by_tuning())  # one tuning
    ['']
    >>> run.draw("figure_18_best_scheme")[0].name, run.write_report().name
    ('figure_18_best_scheme.png', 'report.html')
    >>> run.dataset().sizes["replicate"]  # needs the extra xarray
    2
    >>> len(run.hash), run.place == run.folder  # the run folder still shows this question
    (10, True)
    >>> leaning = owtsweep.run([
    ...     "grid.natural_period=[4]", "grid.amplitude=[1]", "grid.replicates=2",
    ...     "record.duration=60", "schemes=[MKF,HME1]", "over={sensors.imu.tilt: [0,0.01]}",
    ... ])
    >>> leaning.regret()["world"].unique().tolist()
    ['sensors.imu.tilt=0', 'sensors.imu.tilt=0.01']
    """

    folder: Path
    config: Config
    study: Study
    stored_plan: Plan | None = None
    question: str = ""
    home: Path | None = None
    tuning: str = ""

    def __repr__(self) -> str:
        """Return one line with the folder, the study and the number of cases of the plan."""
        plan = self.stored_plan
        cases = "" if plan is None else f", {count_cases(plan)} cases"
        return f"<Run {printable(str(self.folder))}: study {self.study.name}{cases}>"

    def _repr_html_(self) -> str:
        """Return answer, map and link to the page as HTML, for notebooks."""
        from owtsweep.sweep.page import make_excerpt

        rows, _ = self.stored()
        try:
            results = self._find_results(self.make_results(rows))
            return make_excerpt(self.study, self.config, results, self.place)
        except InputError:  # nothing to show yet
            return f"<p>{escape(repr(self))}</p>"

    def dataset(self) -> xarray.Dataset:
        """Return the values of all stored cases as an xarray Dataset.

        A variable for each measure has the dimensions tuning (of a run with several), scheme, the
        conditions, window and replicate; it is NaN where there is no value. Its attributes and
        those of the conditions are name, unit and what is judged; those of the dataset say where
        the run comes from.

        Raises InputError if xarray is not installed (`pip install 'owtsweep[xarray]'`), no case has
        succeeded, or the study's rows are no map.
        """
        from owtsweep.sweep.dataset import make_dataset

        with blame(self.study):
            return make_dataset(self.study, self.engine, self._find_results(None), self.metadata())

    @property
    def place(self) -> Path:
        """The folder of the run's tables and figures.

        It is `folder`, unless another question has been asked of this run folder since. Then it is
        the folder of this run's own question.
        """
        return self.folder if asked.is_shown(self.folder, self.question) else self._own

    @property
    def _own(self) -> Path:
        """The folder of this run's question; `folder` if there is none."""
        own = asked.question_folder(self.folder, self.question)
        return own if self.question and own.is_dir() else self.folder

    @property
    def hash(self) -> str:
        """The hash that identifies the run: 10 hexadecimal digits.

        It is a hash of the configuration without the keys that identify no run (`sweep.keys`).
        """
        return run_hash(self.config)

    @property
    def store(self) -> Store:
        """The store of the run's rows, in the run folder."""
        with blame(self.study):
            return Store(self.home or self.folder, needed_columns(self.study, self.config))

    @property
    def engine(self) -> Engine:
        """The engine of the study that plans, runs and draws the run's configuration."""
        return self.study.engine(self.config)

    def plan(self) -> Plan:
        """Return the run's plan, key -> block: `stored_plan`, or a new plan if that is None.

        A block is the unit of work and storage.
        """
        made = self.stored_plan
        return make_plan(self.study, self.config) if made is None else made

    def by_tuning(self) -> dict[str, Run]:
        """Return tuning -> the run of this tuning alone, in the same folder.

        A run of one tuning has one entry, with the name "": the run itself.
        """
        parts = self.config.by_tuning()
        if "" in parts:
            return {"": self}
        plan = self.plan()
        return {
            name: replace(
                self,
                config=config,
                stored_plan={key: block for key, block in plan.items() if name in block.tunings},
                tuning=name,
            )
            for name, config in parts.items()
        }

    def cases(self) -> pd.DataFrame:
        """Return the rows of all stored cases of the plan, including failed cases, sorted by case.

        Of several worlds (the key `over`) they are those of the nominal one.
        With several tunings, the first column is `tuning`, and the rows of each tuning stand
        together. Blocks that are missing are left out with a logged warning.

        Raises InputError if no case is stored.
        """
        return join_rows(self._finished())

    def _finished(self) -> dict[str, pd.DataFrame]:
        """Return tuning -> rows, as `stored` does, with a warning of missing blocks.

        Raises InputError if no case is stored.
        """
        rows, missing = self.stored()
        if not rows:
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

    def stored(self, world: str = NOMINAL) -> tuple[dict[str, pd.DataFrame], int]:
        """Return tuning -> the rows of all stored cases, and the number of blocks that are missing.

        Of several worlds (the key `over`) they are those of one.

        The tuning is "" in a run of one tuning. A tuning without a stored case is left out. Only
        the shards of the plan are read, no other files in the folder. The rows are sorted, so that
        sums of rows do not depend on the order of the grid. Text columns are categorical, so that
        millions of rows fit into memory.
        """
        with blame(self.study):
            columns = self.engine.sort_columns()
        stored, missing = {}, set()
        for name, part in self.by_tuning().items():
            plan = {k: b for k, b in part.plan().items() if not b.worlds or world in b.worlds}
            rows, absent = self.store.read_all(plan)
            missing.update(absent)
            if rows is not None:
                stored[name] = sort_rows(rows, columns)
        return stored, len(missing)

    def unable(self) -> list[Setback]:
        """Return the stored cases that their scheme cannot compute.

        There is one `Setback` for each block (unit of work) and reason. All files of the run's plan
        are read.
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

        Of one tuning of several, it has the lines of this tuning, without the column `tuning`.

        Raises InputError if the run has no table of this name, or the file is damaged.
        """
        table = read_table(self.place, name)
        if not self.tuning or "tuning" not in table:
            return table
        lines = table[table["tuning"] == self.tuning]
        return lines.drop(columns="tuning").reset_index(drop=True)

    def tables(self) -> dict[str, pd.DataFrame]:
        """Read all tables of the run; return name -> table.

        The result is {} if the run has no tables, e.g. because no case has succeeded yet.

        Raises InputError if a file is damaged.
        """
        return {path.stem: self.table(path.stem) for path in sorted(self.place.glob("*.csv"))}

    def make_results(self, stored: Mapping[str, pd.DataFrame]) -> dict[str, Results]:
        """Make the tables of each tuning with a succeeded case; `stored` is what `stored` returns.

        Raises InputError if the study comes from another package and makes no tables.
        """
        results = {}
        for name, config in self.config.by_tuning().items():
            rows = stored.get(name)
            if rows is not None and (rows["status"] == OK).any():
                with blame(self.study):
                    tables = self.engine.tables(config, rows)
                    if config.over is not None:
                        tables |= self.engine.make_regret(config, self._read_worlds(config.over))
                results[name] = Results(config, rows, tables)
        return results

    def _read_worlds(self, over: Over) -> dict[str, pd.DataFrame]:
        """Return world -> the rows of its stored cases, with a warning of worlds without any."""
        found = {}
        for world in name_worlds(over):
            rows = self.stored(world)[0].get("")
            if rows is None or not (rows["status"] == OK).any():
                logger.warning("over: no case of the world %s has succeeded; it is left out", world)
            else:
                found[world] = rows
        return found

    def draw(
        self,
        only: str | None = None,
        results: Mapping[str, Results] | None = None,
        *,
        overview: bool = False,
    ) -> list[Path]:
        """Draw all figures of the run, or a single figure, into the folder `figures` of `place`.

        They are drawn in the folder of their question, and copied into the root of the run folder
        if it shows this question.

        only: the name of the figure to draw; None draws all figures. With several tunings, the name
            of a tuning's figure ends with the tuning's name; without this ending, the figures of
            all tunings are drawn.
        results: the results to draw by tuning, if they are in memory. If None, the shards are read.
        overview: if True, only the figure of the main result is drawn.
        Returns: the files of the figures. If the run cannot have a figure (e.g. because a scheme is
            missing), the figure is left out with a logged warning, unless `only` names it.
        Raises InputError if no case has succeeded, there is no figure named `only`, or the study
            comes from another package and does not work.
        Raises OSError if the file system refuses a file; figures drawn earlier stay whole.
        """
        folder = self._own / "figures"
        results = self._find_results(results)  # not of the tables' files
        with blame(self.study):
            drawings = list_drawings(self.engine, results, self.metadata())
            only = name_overview(self.engine, results) if overview else only
        for each in (folder, self.place / "figures"):  # drawing takes long: see first if it may
            each.mkdir(exist_ok=True)
        guard = partial(blame, self.study)
        chosen = [name for name in (f"{only}_{tuning}" for tuning in results) if name in drawings]
        if only is None or only in drawings or not chosen:
            files = draw_each(drawings, folder, only, guard)
        else:
            files = [file for name in chosen for file in draw_each(drawings, folder, name, guard)]
        return asked.show_figures(self.folder, self.question, files)

    def write_report(
        self,
        output: Path | None = None,
        results: Mapping[str, Results] | None = None,
        *,
        details: bool = False,
    ) -> Path:
        """Write report.html, one page to send, and return its path.

        output: the file to write; None: report.html beside the run's tables.
        results: the results by tuning, if they are in memory. If None, the shards are read.
        details: whether `keep_details` comes first.
        Raises InputError if no case has succeeded, or the study comes from another package and does
            not work.
        Raises OSError if the file system refuses the file.
        """
        from owtsweep.sweep.page import make_page

        found = self._find_results(results)
        if details:
            self.keep_details(found)
        present = {path.name for path in self.store.cases.glob("*.parquet")}
        missing = sum(self.store.path(key).name not in present for key in self.plan())
        text = make_page(self.study, self.config, found, self.folder, self.place, missing)
        if output is not None:
            write_atomically(output, text)
            return output
        asked.write_both(self.folder, self.question, {asked.PAGE: text})
        return self.place / asked.PAGE

    def keep_details(self, results: Mapping[str, Results] | None = None) -> Path:
        """Run the schemes on record 0 of each cell, and keep 40 s of it and error spectra.

        The page of the run shows them. Returns the path of the file, details.json.

        results: the results by tuning, if they are in memory. If None, the shards are read.
        Raises InputError if no case has succeeded, or the study has no record to show.
        Raises OSError if the file system refuses the file.
        """
        from owtsweep.sweep.page import dump_details, make_details

        details = {}
        for tuning, result in self._find_results(results).items():
            with blame(self.study):
                contents = self.engine.contents(result.config, result.tables, result.rows)
            if contents is None:
                raise InputError(f"--details: a run of the study {self.study.name} has no map")
            details[tuning] = make_details(self.study, result.config, contents)
        asked.write_both(self.folder, self.question, {asked.DETAILS: dump_details(details)})
        return self.place / asked.DETAILS

    def _find_results(self, results: Mapping[str, Results] | None) -> Mapping[str, Results]:
        found = self.make_results(self._finished()) if results is None else results
        require(
            len(found) > 0,
            f"{self.folder}: no case has succeeded, so there is nothing to show; see its run.log",
        )
        return found

    def metadata(self) -> dict[str, str]:
        """Return texts to store in the figures' files: the run's hash and the folder's name."""
        return {"run": self.hash, "folder": printable((self.home or self.folder).name)}

    def summary(self) -> pd.DataFrame:
        """Read `summary.csv`: means of the replicates, with confidence intervals."""
        return self.table("summary")

    def regret(self) -> pd.DataFrame:
        """Read `regret.csv`: each scheme's error and regret in each world of the key `over`.

        `table("regret_summary")` has the mean and the worst regret over the worlds.
        """
        return self.table("regret")

    def best_scheme(self) -> pd.DataFrame:
        """Read `best_scheme.csv`: the best scheme in each cell of the grid.

        The first column is `tuning`, in a run of one tuning too, so that a script serves both. A
        study without tunings has no such column.
        """
        table = self.table("best_scheme")
        if self.config.tuning_name and not self.tuning and "tuning" not in table:
            table.insert(0, "tuning", self.config.tuning_name)
        return table


def plan_run(study: Study, config: Config) -> Run:
    """Return the run of a configuration, which need not have begun, with a new plan.

    Raises InputError as `make_plan`, or if the run folder can have no name.
    """
    plan = make_plan(study, config)
    return Run(run_folder(config), config, study, plan, question=question_hash(config))


def list_drawings(
    engine: Engine, results: Mapping[str, Results], metadata: Mapping[str, str]
) -> dict[str, Drawing]:
    """Return figure name -> function that draws the figure.

    With several tunings, figures that show them together come first, and the name of a figure of
    one tuning ends with the tuning's name. A figure that does not depend on the tuning is listed
    once, without a tuning's name.

    results: the results by tuning; the name is "" in a run of one tuning.
    metadata: Texts to store in the figures' files.
    """
    listed: dict[str, Drawing] = {}
    if "" not in results:
        listed |= engine.joint_drawings(results, metadata)
    for tuning, result in results.items():
        drawings = engine.drawings(result.config, result.tables, result.rows, metadata)
        for name, drawing in drawings.items():
            shared = tuning == "" or name in engine.untuned
            listed.setdefault(name if shared else f"{name}_{tuning}", drawing)
    return listed


def name_overview(engine: Engine, results: Mapping[str, Results]) -> str:
    """Return the name, in `list_drawings`, of the figure of the main result."""
    joint = {} if "" in results else engine.joint_drawings(results, {})
    if joint:
        return next(iter(joint))
    tuning, result = next(iter(results.items()))
    name = engine.overview(result.config)
    return f"{name}_{tuning}" if tuning else name
