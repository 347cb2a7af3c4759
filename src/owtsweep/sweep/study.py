"""What a study is, as far as the machinery of a sweep needs to know.

`owtsweep.sweep` plans, runs, stores, resumes and draws by these protocols alone. It imports no
study, and never looks inside the content of a block.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from owtsweep.results.status import FAILED, OK, UNABLE

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.config import Config
    from owtsweep.figures.drawings import Drawing
    from owtsweep.results.conditions import Condition

__all__ = [
    "FAILED",
    "OK",
    "UNABLE",
    "Block",
    "Engine",
    "Judged",
    "Spectral",
    "Study",
    "add_versions",
]


@dataclass(frozen=True)
class Block:
    """The unit of storage: what one shard holds.

    Attributes
    ----------
    group
        Blocks of one group share expensive inputs (the motion and the noise of a record), so one
        task runs them together.
    label
        How messages name the block.
    content
        Everything that the block's rows depend on and nothing else, as plain JSON data. Its hash
        is the block's key, so two blocks of equal content are the same block.
    cases
        How many cases it holds.
    cases_per_row
        How many cases a row stands for. A row without a number leaves so many of them open.
    anew
        Why the block is computed anew even if it is stored, e.g. because its key cannot cover the
        code that it depends on; empty for most.
    """

    group: str
    label: str
    content: Mapping[str, Any]
    cases: int
    cases_per_row: int = 1
    anew: str = ""


def add_versions(base: int, *rooms: ModuleType) -> int:
    """A study's `numerics_version`: its own base, and the `NUMERICS_VERSION` of the rooms it uses.

    It rises as soon as one of them rises. None may ever fall.
    """
    return base + sum(int(room.NUMERICS_VERSION) for room in rooms)


class Engine(Protocol):
    """One way to answer a study's question, from its plan to its figures."""

    #: Whether the rows are samples (of records, say), so that means over them have intervals.
    samples: bool

    def plan(self, config: Any) -> list[Block]:
        """All blocks of the configuration in a fixed order."""
        ...

    def backend(self, config: Any) -> str:
        """The joblib backend that suits the blocks: "threading" or "loky"."""
        ...

    def run(self, config: Any, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yields each with its rows as soon as it is done.

        Rows have at least the columns `status` (`owtsweep.results.status`) and `reason`, which is
        "" where the status is "ok".
        """
        ...

    def sort_columns(self) -> list[str]:
        """The columns that identify a row; rows are sorted by them before anything is summed."""
        ...

    def tables(self, config: Any, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Tables by name, from all rows of the plan; each is written as `<name>.csv`.

        The rows' text columns may be categorical, as in `owtsweep.sweep.runs.Run.stored`.
        """
        ...

    def terminal(self, config: Any, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """What the terminal shows at the end of a sweep: the answer in a few lines."""
        ...

    def drawings(
        self,
        config: Any,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> Mapping[str, Drawing]:
        """What draws each figure of a run, by the figure's name; `metadata` goes into the files."""
        ...

    def overview(self, config: Any) -> str:
        """The name of the one figure that tells the result, which a sweep draws at its end."""
        ...


class Study(Protocol):
    """A family of experiments with one configuration schema."""

    name: str
    #: Raised when the columns of a shard change.
    schema_version: int
    #: Raised by hand whenever the numbers of a block change for the same content.
    numerics_version: int

    def config_type(self) -> type[Config]:
        """The typed configuration, derived from `owtsweep.config.Config`."""
        ...

    def conditions(self, config: Any) -> tuple[Condition, ...]:
        """The axes of the study's grid, in the order of the tables' columns."""
        ...

    def engine(self, config: Any) -> Engine:
        """What plans, runs and draws this configuration."""
        ...


@runtime_checkable
class Judged(Protocol):
    """A study whose subject was published, so that a run can be held against the print."""

    def write_fidelity(
        self, config: Any, rows: pd.DataFrame, folder: Path, *, metadata: Mapping[str, str]
    ) -> list[Path]:
        """Judge a run with samples; writes `fidelity.html` and more, and returns all files.

        Parameters
        ----------
        config, rows
            The run's configuration, and its cases as `Run.cases` returns them.
        folder
            Made if it does not exist.
        metadata
            Stored in the figures; its `folder` names the run.
        """
        ...


@runtime_checkable
class Spectral(Protocol):
    """A study whose schemes have error spectra that can be computed without any record."""

    def write_spectrum(
        self, config: Any, folder: Path, *, metadata: Mapping[str, str]
    ) -> tuple[list[Path], RenderableType]:
        """Write figures and tables into `folder`, which is made; the files, and what to print."""
        ...
