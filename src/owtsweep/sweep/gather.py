"""Joins the rows of many shards (stored files) to one table, in bounded memory.

An Arrow table of a hundred rows takes some 10 kB in addition to its content, and pandas needs more
memory for text than for numbers. So shards are joined in batches, and each text is stored as an
integer code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

#: Number of shards that are joined at a time.
BATCH = 256


def gather(tables: Iterable[Any]) -> pd.DataFrame | None:
    """Join the rows of all tables, in the order of the tables; return None if there is no table.

    Parameters
    ----------
    tables
        `pyarrow.Table`s. The iterable is read in batches, so that each table can be freed soon.

    Returns
    -------
    DataFrame
        All rows. Text columns are categorical, with sorted categories; `as_text` turns categorical
        columns into plain text. If a table lacks a column, the rows of that table have missing
        values in the column.

    Raises
    ------
    InputError
        If whole numbers of one table are too large for a column that has fractions in another.
    """
    import pandas as pd

    remaining = iter(tables)
    batches = []
    while batch := list(islice(remaining, BATCH)):
        batches.append(_columns(batch))
    if not batches:
        return None
    sizes = [len(next(iter(batch.values()))) for batch in batches]
    names = list(dict.fromkeys(name for batch in batches for name in batch))
    # The pieces of a column are freed as soon as it is whole.
    columns = {name: _whole([batch.pop(name, None) for batch in batches], sizes) for name in names}
    return pd.DataFrame(columns, copy=False)


def join_tunings(frames: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Join the rows of several tunings, with the tuning's name in a new first column `tuning`."""
    import pandas as pd

    sizes = [len(frame) for frame in frames.values()]
    codes = np.repeat(np.arange(len(sizes)), sizes)
    names = pd.Categorical.from_codes(codes, pd.Index(list(frames)))
    columns = dict.fromkeys(name for frame in frames.values() for name in frame)
    whole = {name: _whole([f.get(name) for f in frames.values()], sizes) for name in columns}
    return pd.DataFrame({"tuning": names, **whole}, copy=False)


def sort_rows(frame: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Sort the rows of a frame in place by the values in `columns`; return the frame.

    The first of these columns counts most. Text is sorted alphabetically, missing text comes last,
    and equal rows keep their order. The frame's columns are reordered one by one, so that memory
    never holds a second copy of the whole frame.
    """
    order = np.lexsort([_rank(frame[name]) for name in reversed(columns)])
    for name in frame.columns:
        frame[name] = frame[name].array.take(order)
    return frame


def as_text(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a copy of the frame whose categorical columns are plain text."""
    text = {name: frame[name] for name in frame.columns if _is_categorical(frame[name])}
    return frame.astype({name: column.cat.categories.dtype for name, column in text.items()})


def _columns(tables: list[Any]) -> dict[str, pd.Series[Any]]:
    """Join some Arrow tables; return column name -> values, copied out of Arrow's memory.

    Raises
    ------
    InputError
        If a column's whole numbers in one table and fractions in another do not fit together.
    """
    # Permissive: a column may hold whole numbers in one shard and fractions in another.
    try:
        joined = pa.concat_tables(tables, promote_options="permissive").combine_chunks()
    except pa.ArrowInvalid as error:
        raise InputError(
            f"cases: the numbers of these shards do not fit together ({error})"
        ) from error
    columns = {}
    for name, column in zip(joined.column_names, joined.columns, strict=True):
        if pa.types.is_large_string(column.type) or pa.types.is_string(column.type):
            column = column.dictionary_encode()
        columns[name] = column.to_pandas().copy()
    return columns


def _whole(pieces: list[Any], sizes: list[int]) -> Any:
    """Join successive pieces of one column, each of which comes from one batch of tables.

    A piece is None if its batch lacks the column, and may hold missing values only. `sizes` are the
    numbers of rows of the batches.
    """
    import pandas as pd

    filled = [piece for piece in pieces if piece is not None and not _is_nothing(piece)]
    if not filled:
        return next(piece for piece in pieces if piece is not None).reindex(range(sum(sizes)))
    whole = [
        _nothing_like(filled[0], size) if piece is None or _is_nothing(piece) else piece
        for piece, size in zip(pieces, sizes, strict=True)
    ]
    if _is_categorical(filled[0]):
        return pd.api.types.union_categoricals(whole, sort_categories=True)
    return pd.concat(whole, ignore_index=True)


def _nothing_like(piece: Any, size: int) -> Any:
    """Make a column of `size` missing values, of a type that can be joined with `piece`."""
    import pandas as pd

    if piece.dtype.kind in "iuf":
        return pd.Series(np.full(size, np.nan))
    if piece.dtype.kind == "b":
        return pd.Series(np.full(size, None))
    return pd.Series(index=range(size), dtype=piece.dtype)


def _is_nothing(piece: Any) -> bool:
    if _is_categorical(piece):
        return len(piece.cat.categories) == 0
    return bool(piece.dtype.kind == "O" and piece.isna().all())


def _is_categorical(column: Any) -> bool:
    import pandas as pd

    return isinstance(column.dtype, pd.CategoricalDtype)


def _rank(column: Any) -> Any:
    """Return one number per value of a column, so that sorting by the numbers sorts the values.

    Text is ranked alphabetically. Missing values get the largest number.
    """
    if column.dtype.kind in "iufb":
        return column.to_numpy()
    coded = column.astype("category").cat
    codes = coded.codes.to_numpy(np.int32)
    return np.where(codes < 0, len(coded.categories), codes)
