"""The protocols that a study implements for the machinery of a sweep.

`owtsweep.sweep` plans, runs, stores, resumes and draws through these protocols only. It imports no
study, and never looks inside the content of a block.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from owtsweep.errors import InputError, as_text
from owtsweep.results.status import FAILED, OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.config import Config
    from owtsweep.figures.drawings import Drawing
    from owtsweep.results.conditions import Condition

__all__ = [
    "FAILED", "OK", "UNABLE", "Block", "Engine", "Judged", "Spectral", "Study", "add_versions",
    "blame",
]  # fmt: skip


@dataclass(frozen=True)
class Block:
    """The unit of storage: what one shard holds.

    Attributes
    ----------
    group
        Blocks of one group share expensive inputs (the motion and the noise of a record), so one
        task runs them together.
    label
        The name of the block in messages.
    content
        Everything that the block's rows depend on and nothing else, as plain JSON data. It
        determines the block's key, so two blocks of equal content are the same block.
    cases
        How many cases it holds.
    cases_per_row
        How many cases a row stands for; a row without a number counts as this many cases.
    anew
        Why the block is computed again even if it is stored, e.g. because its key cannot cover the
        code that it depends on; empty for most blocks.
    """

    group: str
    label: str
    content: Mapping[str, Any]
    cases: int
    cases_per_row: int = 1
    anew: str = ""


def add_versions(base: int, *rooms: ModuleType) -> int:
    """A study's `numerics_version`: its base plus the `NUMERICS_VERSION` of the packages it uses.

    The sum rises as soon as one of them rises. None of them may ever be lowered.
    """
    return base + sum(int(room.NUMERICS_VERSION) for room in rooms)


class Engine(Protocol):
    """One way to answer a study's question, from its plan to its figures."""

    #: Whether the rows are samples (e.g. of records), so that means over them have intervals.
    samples: bool

    def plan(self, config: Any) -> list[Block]:
        """All blocks of the configuration in a fixed order."""

    def backend(self, config: Any) -> str:
        """The joblib backend that suits the blocks: "threading" or "loky"."""

    def run(self, config: Any, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yield each block with its rows as soon as it is done.

        Rows have at least the columns `status` (`owtsweep.results.status`) and `reason`, which is
        "" where the status is "ok".
        """

    def sort_columns(self) -> list[str]:
        """The columns that identify a row; rows are sorted by them before anything is summed."""

    def tables(self, config: Any, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Tables by name, from all rows of the plan; each is written as `<name>.csv`.

        The rows' text columns may be categorical, as in `owtsweep.sweep.runs.Run.stored`.
        """

    def terminal(self, config: Any, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """The result in a few lines, shown on the terminal at the end of a sweep."""

    def drawings(
        self,
        config: Any,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """Figure name -> function that draws the figure; `metadata` is stored in the files."""

    def overview(self, config: Any) -> str:
        """The name of the figure that shows the main result; a sweep draws it at its end."""


class Study(Protocol):
    """A family of experiments with one configuration schema."""

    name: str
    #: Increased when the columns of a shard change.
    schema_version: int
    #: Increased by hand whenever the numbers of a block change for the same content.
    numerics_version: int

    def config_type(self) -> type[Config]:
        """The typed configuration, derived from `owtsweep.config.Config`."""

    def conditions(self, config: Any) -> tuple[Condition, ...]:
        """The axes of the study's grid, in the order of the tables' columns."""

    def engine(self, config: Any) -> Engine:
        """The engine that plans, runs and draws this configuration."""


@contextmanager
def blame(study: Study) -> Iterator[None]:
    """Turn any error in the code of another package's study into one line that names the package.

    Raises
    ------
    InputError
        Instead of any error inside the context but those of the file system; errors of built-in
        studies are not changed.
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
        raise InputError(
            f"study: {study.name!r} of the package {package} does not work ({as_text(error)}); "
            "update or uninstall that package"
        ) from error


@runtime_checkable
class Judged(Protocol):
    """A study with published results that a run can be compared with."""

    def write_fidelity(
        self, config: Any, rows: pd.DataFrame, folder: Path, *, metadata: Mapping[str, str]
    ) -> list[Path]:
        """Judge a run with samples; write `fidelity.html` and other files, and return all of them.

        Parameters
        ----------
        config, rows
            The run's configuration, and its cases as `Run.cases` returns them.
        folder
            Created if it does not exist.
        metadata
            Stored in the figures; its `folder` names the run.
        """


@runtime_checkable
class Spectral(Protocol):
    """A study whose schemes have error spectra that can be computed without any record."""

    def write_spectrum(
        self, config: Any, folder: Path, *, metadata: Mapping[str, str]
    ) -> tuple[list[Path], RenderableType]:
        """Write figures and tables into a new `folder`; return the files and the text to print."""
