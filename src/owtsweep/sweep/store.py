"""The store of a run: a folder of immutable files, the shards, each named by a block's key.

A shard is a Parquet file with the rows of one block (unit of work). The store needs no lock and no
index. A shard is whole or absent. The shard's name determines the rows in the shard. So two
processes that write shards of the same name write equal rows.

The page checksums of Parquet cover only the pages. They do not notice a flipped byte in a page
header or in the footer (column names, row counts, versions of the study). So each shard carries a
seal: a digest in the file's metadata, computed from the file with zeros in place of the digest. The
shard also has page checksums, for other readers.
"""

from __future__ import annotations

import io
import logging
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, TypeVar

import pyarrow as pa
import pyarrow.parquet as pq

from owtsweep.errors import InputError, printable
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_bytes
from owtsweep.sweep.gather import gather
from owtsweep.sweep.rows import (
    NOTHING,
    Needed,
    WrongRows,
    check_columns,
    check_statuses,
    check_table,
    kinds_of,
)  # fmt: skip
from owtsweep.sweep.study import FAILED

if TYPE_CHECKING:
    import pandas as pd

logger = logging.getLogger(__name__)

T = TypeVar("T")

#: Most bytes of a shard: some hundred million rows.
MOST_BYTES = 2_000_000_000
#: Prefix of all metadata keys of this package.
PREFIX = "owtsweep."
_SEAL = b"blake2b:"
_SEAL_BYTES = 16
_BLANK = b"0" * (2 * _SEAL_BYTES)
#: Most values per byte of a shard: rows differ, so a file of constants is no shard. Some have 1.4.
_MOST_VALUES = 20

Status = Literal["missing", "done", "failed"]


class DamagedShard(Exception):
    """The error for a file of rows that is damaged or belongs to another block (unit of work).

    The message says what is wrong with the file.
    """


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

        `data` is what `encode` returns.

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
        if not os.path.lexists(path):  # before it is read: another sweep may write it meanwhile
            return None
        try:
            return look(read_bytes(path, MOST_BYTES, links=False), key, self.needed)
        except InputError as error:
            if os.path.lexists(path):
                logger.warning("%s; it counts as missing", error)
        except WrongRows as error:
            _leave_out(path, str(error))
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
        for name, kind in kinds_of(table.schema).items():
            if kind != NOTHING and kinds.setdefault(name, kind) != kind:
                reason = f"its column {name} holds {kind}, elsewhere {kinds[name]}"
                _leave_out(self.path(key), reason)
                return False
        return True


def _leave_out(path: Path, reason: str) -> None:
    text = "%s holds no rows of this study: %s; it counts as missing"
    logger.warning(text, path.name, printable(reason))


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


def encode(
    key: str, rows: pd.DataFrame, metadata: Mapping[str, str], needed: Needed = MappingProxyType({})
) -> bytes:
    """Return rows as the bytes of a sealed Parquet file; equal arguments give equal bytes.

    key: the key of the block (unit of work) to which the rows belong; it is stored in the file.
    rows: the rows; the index of the frame is not stored.
    metadata: Further entries for the file's metadata, e.g. versions; stored under
        `owtsweep.<name>`.
    needed: the columns that the rows must have, as `rows.needed_columns` returns them.
    Raises TypeError if the rows are no DataFrame.
    Raises WrongRows if the rows lack needed columns or hold wrong values, two columns have the same
        name, or a column holds no text, numbers or flags.
    """
    import pandas as pd

    if not isinstance(rows, pd.DataFrame):
        raise TypeError(f"the study's rows are a {type(rows).__name__}, not a DataFrame")
    # Column by column: `Table.from_pandas` takes longer than the rest of this function.
    table = pa.table({str(name): pa.array(rows[name].array, from_pandas=True) for name in rows})
    check_columns(table.schema, needed)
    check_table(table, needed)
    entries = {**metadata, "key": key}
    buffer = io.BytesIO()
    # Uncompressed: pages of a hundred rows would not get smaller, and reading takes half the time.
    with pq.ParquetWriter(
        buffer, table.schema, compression="none", write_page_checksum=True
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(
            {f"{PREFIX}{name}": value for name, value in entries.items()}
            | {f"{PREFIX}seal": (_SEAL + _BLANK).decode()}
        )
    data = buffer.getvalue()
    place = data.rindex(_SEAL) + len(_SEAL)
    return data[:place] + _digest(data) + data[place + len(_BLANK) :]


def decode(data: bytes, key: str, needed: Needed) -> pa.Table:
    """Return the rows of a sealed file as a `pyarrow.Table`, after checking all bytes.

    data: the content of the file.
    key: the key of the block (unit of work) whose rows the file should hold.
    needed: the columns that the rows must have, as `rows.needed_columns` returns them.
    Raises DamagedShard if any byte differs from what was written, or the file is the shard of
        another block.
    Raises WrongRows if the file is undamaged, but its rows lack needed columns or hold wrong
        values.
    """
    with _refusal():
        # Shards are small: Arrow's threads cost more than they save.
        table = _opened(data, key, needed).read(use_threads=False)
        table.validate(full=True)  # text that is no UTF-8 could not be made Python's
        check_table(table, needed)
        return table


def read_statuses(data: bytes, key: str, needed: Needed) -> frozenset[str]:
    """Return the distinct values of the column `status` in a sealed file, after checking all bytes.

    Parameters are those of `decode`.

    Raises DamagedShard if any byte differs from what was written, or the file is the shard of
        another block.
    Raises WrongRows if a needed column is missing or of another type, or a status is unknown.
    """
    with _refusal():
        file = _opened(data, key, {"status": str, **needed})
        statuses = frozenset(file.read(["status"]).column(0).unique().to_pylist())
        check_statuses(statuses)
        return statuses


def _opened(data: bytes, key: str, needed: Needed) -> pq.ParquetFile:
    # The seal is checked first, so the parser never sees damaged bytes.
    place = data.rfind(_SEAL) + len(_SEAL)
    end = place + len(_BLANK)
    if place < len(_SEAL) or end > len(data):
        raise DamagedShard("it has no seal")
    if data[place:end] != _digest(data[:place] + _BLANK + data[end:]):
        raise DamagedShard("its bytes are not those that were written")
    file = pq.ParquetFile(pa.BufferReader(data), page_checksum_verification=True)
    stored = (file.metadata.metadata or {}).get(f"{PREFIX}key".encode(), b"")
    if stored != key.encode():
        name = stored.decode(errors="backslashreplace") or "no key"
        raise DamagedShard(f"it is the shard of another block ({name})")
    values = file.metadata.num_rows * file.metadata.num_columns
    if values > _MOST_VALUES * len(data):
        raise WrongRows(f"it claims {values} values in {len(data)} bytes")
    check_columns(file.schema_arrow, needed)
    return file


@contextmanager
def _refusal() -> Iterator[None]:
    try:
        yield
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise DamagedShard(f"it is no Parquet file ({error})") from error


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=_SEAL_BYTES).hexdigest().encode()
