"""Read the table of sea states: one row per record; two columns are the axes of the map."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.loading import label_files

if TYPE_CHECKING:
    import pandas as pd


def read_table(path: str) -> pd.DataFrame:
    """Read a CSV table with the column `file` and at least one column of numbers.

    File names in the table are relative to the folder of the table; the result has full paths.

    Raises
    ------
    InputError
        If the table cannot be read, lacks one of these columns, has no row, or has a row without a
        file.
    """
    import pandas as pd

    where = f"replay.table: {path}"
    require(Path(path).is_file(), f"{where}: there is no such file")
    try:
        table = pd.read_csv(path, skipinitialspace=True)
    except (ValueError, OSError) as error:
        text = " ".join(str(error).split())
        raise InputError(f"{where}: it cannot be read as CSV ({text})") from None
    columns = ", ".join(str(name) for name in table.columns[:8])
    require("file" in table.columns, f"{where}: it has no column `file`; it has {columns}")
    require(len(table) > 0, f"{where}: it has no row")
    require(
        len(find_axes(table)) > 0,
        f"{where}: it has no column of numbers besides `file`; add e.g. Hs and Tp",
    )
    blank = table["file"].isna()
    require(not blank.any(), f"{where}: row {int(blank.argmax()) + 1} names no file")
    table["file"] = [
        str(p if (p := Path(str(name))).is_absolute() else Path(path).parent / p)
        for name in table["file"]
    ]
    return table


def find_axes(table: pd.DataFrame) -> list[str]:
    """Return the names of the columns of numbers, in order; the first two are the map's axes."""
    numbers = table.select_dtypes("number").columns
    return [str(name) for name in numbers if name != "file"]


def read_sea_states(config: ReplayConfig) -> pd.DataFrame | None:
    """Read the rows of `replay.table` on the replayed records, with labels in the column `file`.

    Returns None if the configuration names no table.

    Raises
    ------
    InputError
        If the table cannot be read, or none of its rows belongs to a record.
    """
    if config.replay.table is None:
        return None
    table = read_table(config.replay.table)
    labels = {_resolve(file): label for label, file in label_files(config.grid.files).items()}
    table["file"] = [labels.get(_resolve(file)) for file in table["file"]]
    require(
        bool(table["file"].notna().any()),
        f"replay.table: {config.replay.table}: it names none of the records; leave FILE out, or "
        "name files of the table",
    )
    kept = table.dropna(subset=["file"]).drop_duplicates("file").reset_index(drop=True)
    return kept[["file", *[c for c in table.columns if c != "file"]]]


def _resolve(file: str) -> str:
    return str(Path(file).resolve())
