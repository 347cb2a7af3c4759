"""What a study is, as far as the sweep machinery needs to know.

`owtsweep.sweep` plans, runs, stores and resumes by this contract alone: it never looks inside a
block's content, and it knows no physics.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from owtsweep.results.status import FAILED as FAILED
from owtsweep.results.status import OK as OK

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.config import Config


@dataclass(frozen=True)
class Block:
    """The unit of storage: what one shard holds.

    Attributes
    ----------
    group
        Blocks of one group share expensive inputs (the motion and the noise of a record), so they
        are run together in one task.
    label
        How messages name the block.
    content
        JSON-serialisable; everything the block's rows depend on and nothing else. Its hash is the
        block's key, so two blocks with equal content are the same block.
    cases
        How many cases it holds, for progress.
    cases_per_row
        How many cases a row stands for; a failed row fails as many.
    """

    group: str
    label: str
    content: Mapping[str, Any]
    cases: int
    cases_per_row: int = 1


class Study(Protocol):
    """A family of experiments with one configuration schema."""

    name: str
    #: Raised when the columns of a shard change.
    schema_version: int
    #: Raised by hand whenever the numbers of a block change for the same content.
    numerics_version: int

    def config_type(self) -> type[Config]:
        """The typed configuration, a frozen dataclass derived from `owtsweep.config.Config`."""
        ...

    def plan(self, config: Any) -> list[Block]:
        """All blocks of the study in a fixed order."""
        ...

    def backend(self, config: Any) -> str:
        """The joblib backend that suits the blocks: "threading" or "loky"."""
        ...

    def run(self, config: Any, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yields each with its rows as soon as it is done.

        Rows have at least the columns `status` ("ok" or "failed") and `reason` ("" when ok).
        """
        ...

    def sort_columns(self) -> list[str]:
        """The columns that identify a row; rows are sorted by them before anything is summed."""
        ...

    def aggregate(self, config: Any, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        """Tables by name, from all rows of the plan; each is written as `<name>.csv`.

        The rows' text columns may be categorical, as in `owtsweep.sweep.runs.Run.stored`.
        """
        ...

    def terminal(self, config: Any, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        """What `sweep` shows at its end: the study's answer in a few lines."""
        ...

    def draw(
        self,
        config: Any,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        folder: Path,
        *,
        only: str | None = None,
        metadata: Mapping[str, str] | None = None,
    ) -> list[Path]:
        """Draw all figures and tables (or the one called `only`) into `folder`; returns the files.

        `sweep` asks for `only=overview`, the one picture that tells the result.
        """
        ...

    def overview(self) -> str:
        """The name of the one figure that `sweep` itself draws."""
        ...
