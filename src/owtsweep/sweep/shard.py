"""Makes and reads the bytes of a shard: a Parquet file with a seal that shows any damage.

A shard holds the rows of one block (unit of work). The page checksums of Parquet cover only the
pages. They do not notice a flipped byte in a page header or in the footer (column names, row
counts, versions of the study). So each shard carries a seal: a digest in the file's metadata,
computed from the file with zeros in place of the digest. The shard also has page checksums, for
other readers.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from hashlib import blake2b
from types import MappingProxyType
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.parquet as pq

from owtsweep.sweep.rows import Needed, WrongRows, check_columns, check_statuses, check_table

if TYPE_CHECKING:
    import pandas as pd

#: Prefix of all metadata keys of this package.
PREFIX = "owtsweep."
_SEAL = b"blake2b:"
_SEAL_BYTES = 16
_BLANK = b"0" * (2 * _SEAL_BYTES)
#: Most values per byte of a shard: rows differ, so a file of constants is no shard. Some have 1.4.
_MOST_VALUES = 20


class DamagedShard(Exception):
    """The error for a file of rows that is damaged or belongs to another block (unit of work).

    The message says what is wrong with the file.
    """


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

    The column is decoded only if the file's statistics do not give its values. Parameters are those
    of `decode`.

    Raises DamagedShard if any byte differs from what was written, or the file is the shard of
        another block.
    Raises WrongRows if a needed column is missing or of another type, or a status is unknown.
    """
    with _refusal():
        file = _opened(data, key, {"status": str, **needed})
        statuses = _distinct(file, "status")
        check_statuses(statuses)
        return statuses


def _distinct(file: pq.ParquetFile, column: str) -> frozenset[str]:
    place = file.schema_arrow.get_field_index(column)
    values: set[str] = set()
    for group in range(file.metadata.num_row_groups):
        limits = file.metadata.row_group(group).column(place).statistics
        if limits is None or not limits.has_min_max or limits.min != limits.max:
            return frozenset(file.read([column]).column(0).unique().to_pylist())
        values.add(limits.min)
    return frozenset(values)


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
