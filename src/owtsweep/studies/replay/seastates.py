"""Read the table `replay.table`: one row per record, with numbers such as those of the sea state.

The first two columns of numbers are the axes of the map of records.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.motion.recorded.checks import LARGEST_VALUE
from owtsweep.motion.recorded.formats.streams import read_chunks
from owtsweep.motion.recorded.formats.table import number_repeats, refuse_damaged, tidy
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import FACTS
from owtsweep.studies.replay.files import label_files

if TYPE_CHECKING:
    import pandas as pd

#: Most bytes of a table of records.
MOST_BYTES = 10_000_000


def read_table(path: str) -> pd.DataFrame:
    """Read a CSV table of records: the column `file`, and at least one column of numbers.

    Names in `file` are relative to the table's folder, with which they begin in the result.
    Raises InputError if the table cannot be read, is too large, lacks a column or a row, or has a
        name twice, a name of records.csv, or a number too large for a map.
    """
    import pandas as pd

    where = f"replay.table: {path}"
    try:
        raw = next(read_chunks(Path(path), MOST_BYTES + 1), b"")
    except InputError as error:
        raise InputError(f"replay.table: {error}") from None
    require(len(raw) <= MOST_BYTES, f"{where}: the table is larger than {MOST_BYTES / 1e6:g} MB")
    require(b"\0" not in raw, f"{where}: the file holds binary data, not text")
    with refuse_damaged(where, "the file cannot be read as CSV", ValueError):
        table = pd.read_csv(io.BytesIO(raw), skipinitialspace=True)
    _make_printable(table)
    _check_columns(table, where)
    columns = ", ".join(str(name) for name in table.columns[:8])
    require("file" in table.columns, f"{where}: the table has no column `file`, only {columns}")
    require(len(table) > 0, f"{where}: the table has no row")
    require(
        len(find_axes(table)) > 0,
        f"{where}: the table has no column of numbers besides `file`; add e.g. Hs and Tp",
    )
    blank = table["file"].isna()
    require(not blank.any(), f"{where}: row {int(blank.argmax()) + 1} names no file")
    table["file"] = [
        str(p if (p := Path(str(name))).is_absolute() else Path(path).parent / p)
        for name in table["file"]
    ]
    return table


def _make_printable(table: pd.DataFrame) -> None:
    table.columns = list(number_repeats([tidy(str(name)) for name in table.columns]))
    for name in table.select_dtypes(exclude="number").columns:
        if name != "file":
            table[name] = [tidy(c) if isinstance(c, str) else c for c in table[name]]


def _check_columns(table: pd.DataFrame, where: str) -> None:
    require("file.1" not in table.columns, f"{where}: the table has two columns `file`; keep one")
    clash = next((name for name in table.columns if name in FACTS), None)
    require(
        clash is None,
        f"{where}: records.csv has a column `{clash}` of its own; rename the table's column",
    )
    for name in find_axes(table):
        large = table[name].abs() > LARGEST_VALUE
        row = int(large.argmax())
        require(
            not large.any(),
            f"{where}: column {name}, row {row + 1}: {table[name].iloc[row]:g} is beyond "
            f"{LARGEST_VALUE:g}; leave the field empty if there is no number",
        )


def find_axes(table: pd.DataFrame) -> list[str]:
    """Return the table's columns of numbers, in order, without `file`."""
    numbers = table.select_dtypes("number").columns
    return [str(name) for name in numbers if name != "file"]


def read_sea_states(config: ReplayConfig) -> pd.DataFrame | None:
    """Read the rows of `replay.table`, if named, that belong to records; `file` is their label.

    Raises InputError if the table cannot be read, or none of its rows belongs to a record.
    """
    if config.replay.table is None:
        return None
    table = read_table(config.replay.table)
    labels = {Path(file).resolve(): label for label, file in label_files(config.grid.files).items()}
    table["file"] = [labels.get(Path(file).resolve()) for file in table["file"]]
    require(
        bool(table["file"].notna().any()),
        f"replay.table: {config.replay.table}: the table names none of the records; leave out "
        "FILE, or name files of the table",
    )
    kept = table.dropna(subset=["file"]).drop_duplicates("file").reset_index(drop=True)
    return kept[["file", *[c for c in table.columns if c != "file"]]]
