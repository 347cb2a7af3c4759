"""Write and read the tables of a run: CSV files whose numbers are read back exactly."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.io.files import write_all

if TYPE_CHECKING:
    import pandas as pd


def write_tables(folder: Path, tables: Mapping[str, pd.DataFrame]) -> None:
    """Write each table as `<name>.csv`, without the index: all, or none if the disk is full."""
    # pandas writes a float as `repr` does: the shortest text that reads back as the same number.
    contents = {}
    for name, table in tables.items():
        contents[folder / f"{name}.csv"] = table.to_csv(index=False, lineterminator="\n")
    write_all(contents)


def write_table(folder: Path, name: str, table: pd.DataFrame) -> Path:
    """Write a table as `<name>.csv`, whole or not at all, without the index; return the file."""
    write_tables(folder, {name: table})
    return folder / f"{name}.csv"


def read_table(folder: Path, name: str) -> pd.DataFrame:
    """Read the table `<name>.csv` of a run's folder.

    An empty field becomes NaN in a column of numbers, and "" in a column of text. A column whose
    fields are all empty is read as numbers.

    Raises
    ------
    InputError
        If the run has no such table, or the file is damaged.
    """
    import pandas as pd

    path = folder / f"{name}.csv"
    if not path.is_file():
        names = sorted(other.stem for other in folder.glob("*.csv"))
        hint = f"it has {', '.join(names)}" if names else "it has none yet: finish its sweep"
        raise InputError(f"{name}: the run {folder} has no such table; {hint}")
    try:
        # The Arrow engine reads numbers exactly; the default engine does so only from pandas
        # 3.1 on. A scheme may be named "NA", so only an empty field is a missing value.
        table = pd.read_csv(path, engine="pyarrow", keep_default_na=False, na_values=[""])
    except (ValueError, UnicodeDecodeError) as error:  # errors of pandas are ValueErrors
        raise InputError(f"{path}: this is no table; run its sweep again") from error
    text = table.select_dtypes(exclude=["number", "bool"]).columns
    return table.fillna(dict.fromkeys(text, ""))
