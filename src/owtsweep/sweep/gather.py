"""Many shards as one table of rows, in bounded memory.

An Arrow table of a hundred rows costs some 20 kB whatever it holds, and text costs pandas far more
than numbers. So shards are joined a batch at a time, and text is kept as a code per row.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any

import pyarrow as pa

if TYPE_CHECKING:
    import pandas as pd

#: Shards that are joined at a time.
BATCH = 256


def gather(tables: Iterable[Any]) -> pd.DataFrame | None:
    """The rows of all tables in their order, or None if there is no table.

    Parameters
    ----------
    tables
        `pyarrow.Table`s; they are let go as they are read.

    Returns
    -------
    DataFrame
        Text columns are categorical, their categories in the order of text; `as_text` makes plain
        text of them. Columns that a table lacks are empty there.
    """
    batches = [_join(batch) for batch in _batched(tables)]
    if not batches:
        return None
    # `empty` columns of one batch take the type that they have in another.
    whole = pa.concat_tables(batches, promote_options="default").unify_dictionaries()
    batches.clear()
    # Each column is let go as soon as pandas has it.
    frame: pd.DataFrame = whole.to_pandas(split_blocks=True, self_destruct=True)
    del whole
    for name in _categorical(frame):
        frame[name] = frame[name].cat.reorder_categories(sorted(frame[name].cat.categories))
    return frame


def sort_rows(frame: pd.DataFrame, columns: list[str]) -> pd.DataFrame:
    """Sort in place, stably, by these columns; text in the order of text. Returns the frame.

    A column at a time: the whole frame is never there twice.
    """
    order = frame[columns].sort_values(columns, kind="stable").index.to_numpy()
    for name in frame.columns:
        frame[name] = frame[name].array.take(order)
    return frame


def as_text(frame: pd.DataFrame) -> pd.DataFrame:
    """A copy whose categorical columns are plain text."""
    return frame.astype({name: frame[name].cat.categories.dtype for name in _categorical(frame)})


def _batched(tables: Iterable[Any]) -> Iterator[list[Any]]:
    remaining = iter(tables)
    while batch := list(islice(remaining, BATCH)):
        yield batch


def _join(tables: list[Any]) -> Any:
    joined = pa.concat_tables(tables, promote_options="default").combine_chunks()
    for index, field in enumerate(joined.schema):
        if pa.types.is_large_string(field.type) or pa.types.is_string(field.type):
            codes = joined.column(index).dictionary_encode()
            joined = joined.set_column(index, field.name, codes)
    return joined


def _categorical(frame: pd.DataFrame) -> list[str]:
    import pandas as pd

    return [name for name in frame.columns if isinstance(frame[name].dtype, pd.CategoricalDtype)]
