"""The tables of a run: CSV files whose numbers read back to the same bits."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.io.files import write_all, write_atomically

if TYPE_CHECKING:
    import pandas as pd

_ROWS = 20_000


def write_tables(folder: Path, tables: Mapping[str, pd.DataFrame]) -> None:
    """Write each table as `<name>.csv`: all of them, or on a full disk none."""
    write_all({folder / f"{name}.csv": _as_csv(table) for name, table in tables.items()})


def write_table(folder: Path, name: str, table: pd.DataFrame) -> Path:
    """Write `<name>.csv`, whole or not at all; the index is not kept."""
    path = folder / f"{name}.csv"
    write_atomically(path, _as_csv(table))
    return path


def _as_csv(table: pd.DataFrame) -> bytes:
    if table.columns.empty:
        return b"\n"
    head = ",".join(map(_quoted, table.columns)) + "\n"
    parts = [head.encode()]
    for first in range(0, len(table), _ROWS):  # the words of many rows would fill the memory
        rows = table.iloc[first : first + _ROWS]
        last = table.columns[-1]
        words = [_text(rows[name], "\n" if name == last else "") for name in table.columns]
        parts.append(_joined(words))
    return b"".join(parts)


def _joined(columns: list[Any]) -> bytes:
    """Columns of words as lines, their ends being part of the last column.

    By Arrow, whose words lie one behind the other in memory: joined they are the file.
    """
    import pyarrow as pa
    from pyarrow import compute

    lines = compute.binary_join_element_wise(*columns, ",")
    _, ends, text = lines.buffers()
    last = pa.Array.from_buffers(pa.int32(), len(lines) + 1, [None, ends])[-1].as_py()
    return bytes(memoryview(text)[:last])


def _text(column: pd.Series[Any], end: str) -> Any:
    """A column as `DataFrame.to_csv` writes it, a `pyarrow.StringArray`; missing values are "".

    `end` is put behind each word.

    Not by pandas itself, which takes most of the time of a large study's tables: a column mostly
    repeats itself, and each value is put into words once.
    """
    import numpy as np
    import pandas as pd
    import pyarrow as pa
    from pyarrow import compute

    if column.dtype == np.float64:
        # By their bits: 0.0 and -0.0 are equal, but not the same.
        codes, bits = pd.factorize(column.to_numpy().view(np.int64))
        words = _shortest(bits.view(np.float64))
    else:
        codes, values = pd.factorize(column, use_na_sentinel=True)
        found = [_quoted(v) if isinstance(v, str) else str(v) for v in values.tolist()]
        codes = np.where(codes < 0, len(found), codes)
        words = pa.array([*found, ""], pa.string())
    if end:
        words = compute.binary_join_element_wise(words, end, "")
    return words.take(pa.array(codes))


def _shortest(values: Array) -> Any:
    """The shortest text that reads back as the same number, as `repr` has it; Arrow's strings.

    Arrow finds the same digits ten times faster. It leaves out ".0", and goes over to exponents at
    other sizes; such values are left to `repr`.
    """
    import numpy as np
    import pyarrow as pa
    from pyarrow import compute

    words = pa.array(values, from_pandas=False).cast(pa.string())
    size = np.abs(values)
    with np.errstate(invalid="ignore"):
        alike = (size >= 1e-4) & (size < 1e9) & (values != np.trunc(values))
    others = values[~alike].tolist()
    if not others:
        return words
    found = pa.array(["" if value != value else repr(value) for value in others], pa.string())
    return compute.replace_with_mask(words, pa.array(~alike), found)


def _quoted(word: str) -> str:
    if not any(character in word for character in ',"\r\n'):
        return word
    return '"' + word.replace('"', '""') + '"'


def read_table(folder: Path, name: str) -> pd.DataFrame:
    """Read `<name>.csv`.

    An empty field is NaN among numbers and empty text among text; a column of nothing else is read
    as numbers.

    Raises
    ------
    InputError
        If the run has no such table.
    """
    import pyarrow as pa
    from pyarrow import csv

    path = folder / f"{name}.csv"
    if not path.is_file():
        names = sorted(other.stem for other in folder.glob("*.csv"))
        known = f"it has {', '.join(names)}" if names else "it has none yet: finish its sweep"
        raise InputError(f"{name}: the run {folder} has no such table; {known}")
    # Not pandas.read_csv: before pandas 3.1 it is off by one in the last bit unless told not to be,
    # and by default it reads a scheme called "NA" as a missing one.
    options = csv.ConvertOptions(null_values=[""], strings_can_be_null=False)
    try:
        table = csv.read_csv(path, convert_options=options)
    except (pa.ArrowException, UnicodeDecodeError) as error:
        raise InputError(f"{path}: this is no table; run its sweep again") from error
    empty = [field.name for field in table.schema if pa.types.is_null(field.type)]
    frame: pd.DataFrame = table.to_pandas()
    return frame.astype(dict.fromkeys(empty, float))
