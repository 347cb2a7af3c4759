"""Defines what a study and its engines are to the machinery of a sweep: two base classes.

`owtsweep.sweep` plans, runs, stores, resumes and draws through these alone. The package
`owtsweep.sweep` imports no study, and never looks inside the content of a block.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

from owtsweep.config import AnyConfig, Config, Plain
from owtsweep.errors import InputError, as_text, require
from owtsweep.results.status import FAILED, OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.comparing.comparison import Aspects, Candidate, Comparison, Findings
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.figures.drawings import Drawing
    from owtsweep.results.conditions import Condition, Value
    from owtsweep.results.contents import Contents
    from owtsweep.sweep.gather import Results

    C = TypeVar("C", bound=Config)


__all__ = [
    "FAILED", "OK", "UNABLE", "Block", "Engine", "Look", "PlaceQuestion", "Placed", "Square",
    "Study", "Tuned", "Varied", "add_versions", "blame", "broken_study",
]  # fmt: skip


@dataclass(frozen=True)
class Block:
    """A block, the unit of work and storage: a set of cases whose rows are stored in one file.

    group: the name of the block's group. Blocks of one group share expensive inputs (the motion and
        the noise of a record), so one task runs them together.
    label: the name of the block in messages.
    content: Everything on which the block's rows depend, and nothing else, as plain JSON data. The
        content determines the block's key, so two blocks of equal content count as one block.
    cases: Number of cases of the block.
    cases_per_row: Number of cases for which one row of the block stands, e.g. a row that says why
        these cases have no number.
    recompute: why the block is computed again even if it is stored, e.g. because the block's
        key cannot cover the code on which the rows depend; "" for most blocks.
    tunings: the tunings to which the block's rows belong, if the run has several
        (`Config.by_tuning`); else (). The plan sets them: the block's key does not depend on the
        names of tunings.
    worlds: the worlds to which they belong, if the run has several (the key `over`); else ().
    """

    group: str
    label: str
    content: Plain
    cases: int
    cases_per_row: int = 1
    recompute: str = ""
    tunings: tuple[str, ...] = ()
    worlds: tuple[str, ...] = ()

    def choose(self, config: C) -> C:
        """Return the configuration, of one tuning, with which the block is computed."""
        return config.by_tuning()[self.tunings[0] if self.tunings else ""]


class Look(NamedTuple):
    """The next look at a map, of which some cells are not decided.

    blocks: All blocks of the cells and schemes that are looked at again.
    found: What the look before has found, in words.
    """

    blocks: list[Block]
    found: str


class Square(float):
    """The type that `row_types` of an engine gives to a column of mean squares or mean products.

    Each number of the column is 0 or at least 1e-300 away from 0, because no study makes others.
    """


def add_versions(base: int, *rooms: ModuleType) -> int:
    """Return a study's `numerics_version`: `base` plus the `NUMERICS_VERSION` of all `rooms`.

    `rooms` are the modules (packages of owtsweep) that the study uses. The sum rises as soon as
    `base` or one of these numbers rises. Neither `base` nor any of these numbers may ever be
    lowered.
    """
    return base + sum(int(room.NUMERICS_VERSION) for room in rooms)


class Engine(ABC):
    """The base class of an engine: one way to answer a study's question, from plan to figures."""

    #: Whether rows are samples (e.g. of records), so that means of rows have confidence intervals.
    samples: bool
    #: Columns without which no table can be made -> `str`, `float` (any number) or `Square`.
    row_types: Mapping[str, type] = MappingProxyType({})
    #: Names of the figures in `drawings` that do not depend on the tuning.
    untuned: frozenset[str] = frozenset()

    @abstractmethod
    def plan(self, config: AnyConfig) -> list[Block]:
        """Return all blocks (units of work) of the configuration, always in the same order."""

    def plan_look(self, config: AnyConfig, rows: pd.DataFrame) -> Look | None:
        """Return what is to be run for the next look; None if all cells are decided.

        `rows` are those of all looks before, and nothing else determines the result.
        """
        return None

    @abstractmethod
    def backend(self, config: AnyConfig) -> str:
        """Return the joblib backend that suits the blocks: "threading" or "loky" (processes)."""

    @abstractmethod
    def run(
        self, config: AnyConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yield each block with its rows as soon as the block is done.

        A group is all blocks (units of work) with the same `Block.group`, which share inputs.
        Rows have at least the columns `status` (`owtsweep.results.status`) and `reason`. The reason
        is "" in a row with the status "ok".
        """

    @abstractmethod
    def sort_columns(self) -> list[str]:
        """Return the columns that identify a row; rows are sorted by these columns before sums."""

    @abstractmethod
    def tables(self, config: AnyConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Make the tables from all stored rows of the plan; return them by name.

        Each table is written as `<name>.csv`. Text columns of `rows` may be categorical, as in
        `owtsweep.sweep.runs.Run.stored`.
        """

    def make_regret(
        self, config: AnyConfig, rows: Mapping[str, pd.DataFrame]
    ) -> dict[str, pd.DataFrame]:
        """Make the tables of regret from the rows of each world, by name, as `tables` does.

        It is called for a configuration with the key `over`.
        """
        raise NotImplementedError

    @abstractmethod
    def terminal(self, config: AnyConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """Return the main result in a few lines, to be shown on the terminal after a sweep.

        `tables` are the tables by name, as `tables` returns them.
        """

    def spectra(self, config: AnyConfig) -> pd.DataFrame | None:
        """Return the schemes' error spectra for a page; None without any.

        Columns: scheme, frequency (Hz), then measures: mean square errors over the mean square of
        the motion.
        """
        return None

    def contents(
        self, config: AnyConfig, tables: Mapping[str, pd.DataFrame], rows: pd.DataFrame
    ) -> Contents | None:
        """Return what the page of a run shows besides its tables; None without a map.

        `tables` are what the method `tables` makes of `rows`, the stored rows of the plan.
        """
        return None

    @abstractmethod
    def drawings(
        self,
        config: AnyConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """Return figure name -> function that draws the figure.

        `tables` are what the method `tables` makes of `rows`, the stored rows of the plan.
        `metadata` holds texts by name to store in the figures' files.
        """

    @abstractmethod
    def overview(self, config: AnyConfig) -> str:
        """Return the name of the figure that shows the main result, drawn at the end of a sweep."""

    def joint_drawings(
        self, results: Mapping[str, Results], metadata: Mapping[str, str]
    ) -> Mapping[str, Drawing]:
        """Return the figures that show several tunings together; the main result comes first.

        `results` holds the results by tuning. There may be no such figure.
        """
        return {}

    def warm_up(self, config: AnyConfig) -> None:  # noqa: B027
        """Do work that is due once, e.g. warn of what the configuration makes doubtful.

        It is called in the process of the sweep, once per tuning, and only if blocks are missing.
        """

    def predict(
        self, config: AnyConfig, blocks: Sequence[Block], workers: int
    ) -> tuple[float, float] | None:
        """Return the computing time of blocks in s, and the memory of the sweep in bytes.

        The time is the sum over the blocks; several workers share it. Return None if nobody has
        measured blocks of this kind, e.g. those of a user's scheme.
        """
        return None


class Lever(NamedTuple):
    """A change of one key that may lessen the errors.

    words: what is done, e.g. "half the noise of a fix".
    key: of the configuration, or a config group; `grid.` and the name of an axis for the one value
        that this axis has.
    change: Returns the new value of the key's value; None: there is nothing to change.
    near: factors of the key's value that are tried in this order where the new one is refused: a
        rate must fit another one, a delay its steps.
    """

    words: str
    key: str
    change: Callable[[Any], Any]
    near: tuple[float, ...] = ()


def halve(value: float | None) -> float | None:
    """Return half of a value; None if it is zero or not set."""
    return value / 2.0 if value else None


def halve_whole(value: float | None) -> float | None:
    """Return half of a whole number, rounded down; None if it is zero or not set."""
    return float(int(value) // 2) if value else None


def halve_logarithm(factor: float) -> float | None:
    """Return the root of a factor on a true value; None if it is one already."""
    return sqrt(factor) if factor != 1.0 else None


def double(value: float | None) -> float | None:
    """Return twice a value; None if it is zero or not set."""
    return 2.0 * value if value else None


class Study(ABC):
    """The base class of a study: a family of experiments that share one type of configuration."""

    name: str
    #: Increased when the columns of a shard change.
    schema_version: int = 1
    #: Increased by hand whenever the numbers of a block change for the same content.
    numerics_version: int = 1
    #: The commands that work for the study besides those that work for every one: "compare",
    #: "estimate" (that is `owtsweep.estimate`), "place", "spectrum", "tune", "vary". The study
    #: overrides those methods below that they call.
    commands: frozenset[str] = frozenset()

    #: What `report --details` shows of a record over time: a quantity of `estimate`, the number
    #: of its component, and both in words with the unit. None without `estimate`.
    stretched: tuple[str, int, str] | None = None

    #: What `advise` tries to lessen the errors.
    levers: Sequence[Lever] = ()
    #: Schemes that `advise` adds to the configuration's own.
    advised_schemes: Sequence[str] = ()
    #: Number of records over which `advise` measures the error of the best scheme, where these cost
    #: seconds; 0: those that decided.
    advised_records: int = 0

    @abstractmethod
    def config_type(self) -> type[Config]:
        """Return the class of the study's configurations, derived from `owtsweep.config.Config`."""

    @abstractmethod
    def conditions(self, config: AnyConfig) -> tuple[Condition, ...]:
        """Return the axes of the study's grid, in the order of the tables' columns."""

    @abstractmethod
    def engine(self, config: AnyConfig) -> Engine:
        """Return an engine that plans, runs and draws this configuration."""

    def schemes(self) -> Mapping[str, str]:
        """Return name -> description in one sentence of each scheme, for `list`."""
        return {}

    def explain_schemes(self) -> Mapping[str, str]:
        """Return name -> what each scheme is, for somebody who does not have this program."""
        return self.schemes()

    def describe_scheme(self, name: str) -> Mapping[str, str]:
        """Return facts on one of `schemes` in words, for `list`: its size, its keys, and so on."""
        return {}

    def list_simplicity(self) -> Mapping[str, int]:
        """Return name -> simplicity of each of `schemes`, by which ties are broken."""
        return {}

    def complete(self, plain: Plain) -> Plain:
        """Return composed keys with the values that follow from other keys filled in.

        This happens before the keys are typed, so that config.yaml stores the values.
        """
        return plain

    def check(self, config: AnyConfig) -> None:  # noqa: B027 - a study need not check more
        """Check that the study can run a configuration, after `Config.check` of its keys.

        Raises InputError if keys, schemes and motion do not fit together, or a value is refused.
        """

    def check_over(self, config: AnyConfig) -> None:
        """Check the key `over`, after `check`.

        Raises InputError if the study has no such axis, or a world on it cannot be made.
        """
        require(
            config.over is None,
            f"over: nothing departs from what schemes are told in the study {self.name}; leave it "
            "out",
        )

    def check_outside(self, config: AnyConfig) -> None:  # noqa: B027
        """Check what lies outside of the configuration: files, and keys of other studies.

        This happens when a configuration is composed, after `check`. It never happens when a run is
        read: a stranger's run opens no file that it names.

        Raises InputError if a file cannot be used, or another study refuses its keys.
        """

    def list_worlds(self, config: AnyConfig) -> Mapping[str, str]:
        """Return name -> how it departs, of the worlds that the key `over` may name."""
        return {}

    def find_bound(self, config: AnyConfig) -> float | None:
        """Return the least mean of what is judged that is possible in the grid's only cell.

        It is a mean square where errors are roots of these; None if no bound is known.
        """
        return None

    def describe_origin(self, config: AnyConfig) -> str:
        """Return in a line what the run's numbers depend on: truth, tuning, seed, records per cell.

        The line is empty if the study does not say.
        """
        return ""

    def describe_code(self, config: AnyConfig) -> object:
        """Return a description of the user's own code that the keys of a configuration name.

        The description is JSON data and is stored with the run, since the code itself is not
        executed when the run is read. It is None if keys cannot name code.
        """
        return None

    def hide_code(self, plain: Plain, described: object) -> Plain:
        """Return the keys of a stored run without names of code, so that no code is executed.

        plain: the keys of the stored run, as nested dicts, lists and scalars.
        described: the description that `describe_code` returned when the run was made.
        Raises InputError if the description does not fit the keys.
        """
        return plain

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """Compare runs, write figures into `folder`, and return tables, figures and text.

        comparison: the runs, and the pairs of runs to compare.
        folder: Folder for the figures.
        metadata: Name -> text; these texts are stored inside the files of the figures.
        Raises InputError if these runs cannot be compared. In this case nothing is written.
        """
        from owtsweep.comparing.compare import compare

        return compare(comparison, folder, self.describe_run, metadata=metadata)

    def describe_run(self, run: Candidate) -> Aspects:
        """Return what `compare` must know of a run: axes, schemes, and what makes its records."""
        raise NotImplementedError

    def estimate(self, config: AnyConfig, replicate: int) -> EstimatedRecord:
        """Make the record with the number `replicate`, and run all schemes on it.

        The record and its measurements are those of a sweep. The configuration has one tuning.

        Raises InputError if the configuration's grid has several cells.
        """
        raise NotImplementedError

    def write_spectrum(
        self, config: AnyConfig, folder: Path, *, metadata: Mapping[str, str]
    ) -> tuple[list[Path], RenderableType]:
        """Write figures and tables of the schemes' error spectra into `folder`, which is created.

        An error spectrum is the error due to motion at each frequency. It needs no simulated
        record. Return the paths of the files, and the text to print on the terminal. `metadata`
        holds texts by name to store in the figures' files.
        """
        raise NotImplementedError

    def count_trials(self, config: AnyConfig) -> int:
        """Return how many trials `tune` will make in search of the numbers of the schemes.

        Raises InputError if there is nothing to search.
        """
        raise NotImplementedError

    def tune(self, config: AnyConfig, advance: Callable[[str], None]) -> Tuned:
        """Search the best numbers; call `advance` with the scheme's name after each trial."""
        raise NotImplementedError

    def list_vary_defaults(self, plain: Plain) -> Sequence[str]:
        """Return the overrides that `vary` puts before those of the user.

        The command leaves out an override whose key the user sets, or whose section. `plain` has
        the keys as the user's overrides compose them, with one value of the varied key.
        """
        raise NotImplementedError

    def check_vary(self, along: Condition, configs: Mapping[Value, AnyConfig]) -> None:
        """Check that `vary` can compute the errors of these configurations and show them together.

        The arguments are those of `vary`.

        Raises InputError if they cannot be computed or shown together.
        """
        raise NotImplementedError

    def vary(self, along: Condition, configs: Mapping[Value, AnyConfig]) -> Varied:
        """Compute the errors of all schemes with each configuration, which `check_vary` has passed.

        along: the key that is varied: its name as `label`, its unit and its scale.
        configs: Value of the key -> the configuration with this value, in the order of the table.
        Raises InputError if a scheme cannot be computed.
        """
        raise NotImplementedError

    def predict_vary(self, configs: Mapping[Value, AnyConfig]) -> tuple[float, float] | None:
        """Return how long `vary` takes on this machine, s, and its memory, bytes; None: unknown."""
        return None

    def predict_tune(self, config: AnyConfig) -> tuple[float, float] | None:
        """Return how long `tune` takes on this machine, s, and its memory, bytes; None: unknown."""
        return None

    def list_place_defaults(self, given: Collection[str]) -> Sequence[str]:
        """Return the overrides that `place` puts before those of the user, who sets `given`.

        Raises InputError if a key that the user sets has no part in the choice.
        """
        raise NotImplementedError

    def place(self, config: AnyConfig, question: PlaceQuestion) -> Placed:
        """Choose sensors one by one, and predict their errors without running a scheme.

        Raises InputError if the configuration or the question cannot be answered; the message says
            what could.
        """
        raise NotImplementedError


@contextmanager
def blame(study: Study) -> Iterator[None]:
    """Turn an error of a study from another package into one line that names the other package.

    Errors of owtsweep's own studies are not changed.

    Raises InputError: Instead of any Exception or SystemExit that the code of the other package
        raises inside the context. InputError and OSError are not changed.
    """
    try:
        yield
    except (InputError, OSError):
        raise
    except (Exception, SystemExit) as error:
        module = type(study).__module__.partition(".")[0]
        if module == __name__.partition(".")[0]:
            raise
        from importlib.metadata import packages_distributions

        package = packages_distributions().get(module, [module])[0]
        raise broken_study(study.name, package, as_text(error)) from error


def broken_study(name: str, package: str, reason: str) -> InputError:
    """Make (but do not raise) the InputError which says that another package's study is broken.

    `name` is the study's name, `package` the name of the package, and `reason` the error in one
    line.
    """
    return InputError(
        f"study: {name!r} of the package {package} does not work ({reason}); "
        "update or uninstall that package"
    )


class Tuned(Protocol):
    """The result of a search for a tuning."""

    @property
    def trials(self) -> int:
        """Number of trials made."""

    @property
    def stopped(self) -> bool:
        """Whether the user stopped the search before its end."""

    def text(self, name: str) -> str:
        """Return the text of a tuning file that sets the best numbers found; `name` names it."""

    def judge(self) -> RenderableType:
        """Run records with the tuning before and after; return what was gained, to be printed."""


class Varied(Protocol):
    """The errors of a study's schemes over the values of one key."""

    def write(self, folder: Path, metadata: Mapping[str, str]) -> list[Path]:
        """Write the table vary.csv and the figure into `folder`; return the paths of the files.

        `metadata` holds texts by name to store in the figure's files.
        """

    def answer(self) -> RenderableType:
        """Return what the terminal shows: a short table, and sentences that answer."""


@dataclass(frozen=True)
class PlaceQuestion:
    """What `place` is asked, besides the configuration.

    quantity: Name of the quantity whose error the sensors shall lower; None: the study's first.
    count: Most sensors to choose; None leaves it to the study.
    heights: Heights to choose from, in m; None leaves them to the study.
    given: the keys that the user sets by overrides.
    """

    quantity: str | None
    count: int | None
    heights: tuple[float, ...] | None
    given: frozenset[str]


class Placed(Protocol):
    """How many sensors are enough, and where they go."""

    @property
    def config(self) -> Config:
        """The configuration, with the sensors that are there already."""

    def table(self) -> pd.DataFrame:
        """Return a row for each number of sensors, with their heights and the predicted error."""

    def answer(self) -> RenderableType:
        """Return what the terminal shows: the answer, a short table, and what it rests on."""
