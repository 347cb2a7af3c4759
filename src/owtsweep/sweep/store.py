"""The store of a run: a folder of immutable files, the shards, each named by a block's key.

A shard holds the rows of one block (unit of work). The store needs no lock and no index. A shard is
whole or absent. The shard's name determines the rows in the shard. So two processes that write
shards of the same name write equal rows.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeVar

import pyarrow as pa

from owtsweep.errors import InputError, printable
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_bytes
from owtsweep.sweep.gather import gather
from owtsweep.sweep.rows import NOTHING, Needed, WrongRows, kinds_of
from owtsweep.sweep.shard import DamagedShard, decode, read_statuses
from owtsweep.sweep.study import FAILED

if TYPE_CHECKING:
    import pandas as pd

logger = logging.getLogger(__name__)

T = TypeVar("T")

#: Most bytes of a shard: some hundred million rows.
MOST_BYTES = 2_000_000_000

Status = Literal["missing", "done", "failed"]


@dataclass(frozen=True)
class Store:
    """The store of one run's shards; a shard is a file with the rows of one block (unit of work).

    Every read verifies all bytes and the key. If a file is damaged, it is renamed `*.damaged`, a
    warning is logged, and the file's block counts as missing. A block counts as missing too if its
    file is whole but holds no rows of this study. Such a file keeps its name, because another
    version of the study may have written it.

    folder: the run folder.
    needed: the columns that every shard must have, as `rows.needed_columns` returns them.
    read_only: if True, a damaged shard keeps its name, and nothing is written.
    """

    folder: Path
    needed: Needed = field(default_factory=dict)
    read_only: bool = False

    @property
    def cases(self) -> Path:
        """The folder of the shards (files of rows); it may not exist yet."""
        return self.folder / "cases"

    def path(self, key: str) -> Path:
        """Return the path of the shard of the block with the key `key`; the file may not exist."""
        return self.cases / f"part-{key}.parquet"

    def write(self, key: str, data: bytes) -> None:
        """Write the shard of the block with the key `key`, whole or not at all.

        `data` is what `shard.encode` returns.

        Raises OSError if the file cannot be written.
        """
        write_atomically(self.path(key), data)

    def read(self, key: str) -> pd.DataFrame | None:
        """Read the rows of the block with the key `key`, exactly as they were written.

        Return None if there is no shard of the block, or the shard cannot be used.
        """
        table = self._verified(key, decode)
        if table is None:
            return None
        frame: pd.DataFrame = table.to_pandas()
        return frame

    def read_all(self, keys: Iterable[str]) -> tuple[pd.DataFrame | None, list[str]]:
        """Read the rows of many blocks, in the order of the keys.

        Return one frame of all rows, and the keys of the blocks that are missing. The frame is None
        if all blocks are missing. If a shard lacks a column that other shards have, the shard's
        rows have missing values in this column. A shard whose column holds another kind of values
        than in earlier shards counts as missing. Text columns are categorical.
        """
        missing: list[str] = []
        kinds: dict[str, str] = {}

        def tables() -> Iterator[pa.Table]:
            for key in keys:
                table = self._verified(key, decode)
                if table is None or not self._fits(key, table, kinds):
                    missing.append(key)
                else:
                    yield table

        return gather(tables()), missing

    def status(self, key: str) -> Status:
        """Return whether the block with the key `key` is "missing", "done" or "failed".

        A block is "missing" if it has no shard that can be used. A stored block is "failed" if at
        least one of its cases failed; otherwise it is "done". A case that its scheme cannot compute
        does not count as failed, so it is not computed again.
        """
        statuses = self.statuses(key)
        if statuses is None:
            return "missing"
        return "failed" if FAILED in statuses else "done"

    def statuses(self, key: str) -> frozenset[str] | None:
        """Return the distinct statuses of a block's rows; None if the block counts as missing.

        `key` is the key of the block. A status is e.g. "ok".
        """
        return self._verified(key, read_statuses)

    def clear(self) -> None:
        """Delete all shards (files of rows), including damaged files that were renamed."""
        # Delete by name, not the whole folder: other files in the folder are kept.
        for path in self.cases.glob("*part-*.parquet*"):
            path.unlink(missing_ok=True)

    def _verified(self, key: str, look: Callable[[bytes, str, Needed], T]) -> T | None:
        """Call `look` with the bytes of a block's shard, and return what `look` returns.

        `key` is the key of the block. Return None if there is no shard. Return None and log a
        warning if the shard is damaged or holds wrong rows.
        """
        path = self.path(key)
        try:
            return look(read_bytes(path, MOST_BYTES, links=False), key, self.needed)
        except InputError as error:
            if os.path.lexists(path):
                logger.warning("%s; it counts as missing", error)
        except WrongRows as error:
            _leave_out(path, error)
        except DamagedShard as error:
            if self.read_only:
                logger.warning("%s is damaged: %s", path.name, printable(str(error)))
            else:
                _set_aside(path, printable(str(error)))
        return None

    def _fits(self, key: str, table: pa.Table, kinds: dict[str, str]) -> bool:
        """Return whether the columns of a shard hold the same kinds of values as in earlier shards.

        If not, log a warning. `table` holds the rows of the shard of the block `key`. `kinds` maps
        column names to the kinds in earlier shards, e.g. "text". New columns are added to `kinds`.
        """
        try:
            for name, kind in kinds_of(table.schema).items():
                if kind != NOTHING and kinds.setdefault(name, kind) != kind:
                    raise WrongRows(f"its column {name} holds {kind}, elsewhere {kinds[name]}")
        except WrongRows as error:
            _leave_out(self.path(key), error)
            return False
        return True


def _leave_out(path: Path, error: WrongRows) -> None:
    reason = printable(str(error))
    logger.warning("%s holds no rows of this study: %s; it counts as missing", path.name, reason)


def _set_aside(path: Path, reason: str) -> None:
    target = path.with_name(f"{path.name}.damaged")
    number = 2
    while target.exists():
        target = path.with_name(f"{path.name}.{number}.damaged")
        number += 1
    try:
        path.rename(target)
    except OSError as error:
        # The folder is read-only, or another process renamed it first: the shard is missing anyway.
        logger.warning("%s is damaged: %s; it is ignored (%s)", path.name, reason, error)
    else:
        logger.warning("%s is damaged: %s; kept as %s", path.name, reason, target.name)
