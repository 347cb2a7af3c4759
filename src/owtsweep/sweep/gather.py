"""Joins the rows of many shards (stored files) to one table, and the results of several tunings.

Memory is bounded. An Arrow table of a hundred rows takes some 10 kB in addition to its content, and
pandas needs more memory for text than for numbers. So shards are joined in batches, and each text
is stored as an integer code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from owtsweep.arrays import Array
from owtsweep.config import Config
from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

#: Number of shards that are joined at a time.
BATCH = 256


@dataclass(frozen=True)
class Results:
    """The results of a run of one tuning.

    config: the run's configuration.
    rows: the rows of the run's cases, sorted.
    tables: the tables that the study makes of the rows, by name.
    """

    config: Config
    rows: pd.DataFrame
    tables: dict[str, pd.DataFrame]


def gather(tables: Iterable[pa.Table]) -> pd.DataFrame | None:
    """Join the rows of all tables, in the order of the tables; return None if there is no table.

    tables: `pyarrow.Table`s. The iterable is read in batches, so that each table can be freed soon.
    Returns: All rows. Text columns are categorical, with sorted categories; `as_text` turns
        categorical columns into plain text. If a table lacks a column, the rows of that table have
        missing values in the column.
    Raises InputError if whole numbers of one table are too large for a column that has fractions in
        another.
    """
    # Arrow's own pool would keep what is freed here from pandas.
    pa.set_memory_pool(pa.system_memory_pool())
    remaining = iter(tables)
    batches = []
    while batch := list(islice(remaining, BATCH)):
        batches.append(_encode_texts(_join(batch).combine_chunks()))
    if not batches:
        return None
    whole = _join(batches).unify_dictionaries().replace_schema_metadata()
    batches.clear()
    # Column by column, each of which is freed as soon as pandas has it.
    frame: pd.DataFrame = whole.to_pandas(split_blocks=True, self_destruct=True)
    for name in _list_categorical(frame):
        codes = frame[name].cat
        frame[name] = codes.reorder_categories(sorted(codes.categories))
    return frame


def sort_rows(frame: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Sort the rows of a frame in place by the values in `columns`; return the frame.

    The first of these columns counts most. Text is sorted alphabetically, missing text comes last,
    and equal rows keep their order. The frame's columns are reordered one by one, so that memory
    never holds a second copy of the whole frame.
    """
    order = np.lexsort([_rank(frame, name) for name in reversed(columns)])
    for name in frame.columns:
        frame[name] = frame[name].array.take(order)
    return frame


def as_text(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a copy of the frame whose categorical columns are plain text."""
    return frame.astype(
        {name: frame[name].cat.categories.dtype for name in _list_categorical(frame)}
    )


def join_rows(stored: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return the rows of all tunings, with plain text; with several, column `tuning` is first."""
    return _join_tunings({tuning: as_text(rows) for tuning, rows in stored.items()})


def join_tables(results: Mapping[str, Results]) -> dict[str, pd.DataFrame]:
    """Return the tables of all tunings by name; with several, `tuning` is their first column."""
    names = dict.fromkeys(name for part in results.values() for name in part.tables)
    return {
        name: _join_tunings({tuning: part.tables[name] for tuning, part in results.items()})
        for name in names
    }


def _join_tunings(parts: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    import pandas as pd

    if "" in parts:
        return parts[""]
    whole = pd.concat(parts.values(), ignore_index=True)
    whole.insert(0, "tuning", [tuning for tuning, part in parts.items() for _ in range(len(part))])
    return whole


def _join(tables: list[pa.Table]) -> pa.Table:
    # Permissive: a column may hold whole numbers in one shard and fractions in another.
    try:
        return pa.concat_tables(tables, promote_options="permissive")
    except pa.ArrowInvalid as error:
        raise InputError(
            f"cases: the numbers of these shards do not fit together ({error})"
        ) from error


def _encode_texts(table: pa.Table) -> pa.Table:
    for place, (name, column) in enumerate(zip(table.column_names, table.columns, strict=True)):
        if pa.types.is_large_string(column.type) or pa.types.is_string(column.type):
            table = table.set_column(place, name, column.dictionary_encode())
    return table


def _list_categorical(frame: pd.DataFrame) -> list[str]:
    return [str(name) for name in frame.select_dtypes("category")]


def _rank(frame: pd.DataFrame, name: str) -> Array:
    """Return one number per value of a column, so that sorting by the numbers sorts the values.

    Text is ranked alphabetically. Missing values get the largest number.
    """
    column = frame[name]
    if column.dtype.kind in "iufb":
        return column.to_numpy()
    coded = column.astype("category").cat
    codes = coded.codes.to_numpy(np.int32)
    return np.where(codes < 0, len(coded.categories), codes)
