"""The tables of a run: CSV files whose numbers read back to the same bits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.sweep.files import write_atomically

if TYPE_CHECKING:
    import pandas as pd


def write_table(folder: Path, name: str, table: pd.DataFrame) -> Path:
    """Write `<name>.csv`, whole or not at all; the index is not kept."""
    path = folder / f"{name}.csv"
    # Without a format pandas writes the shortest text that is the same float.
    write_atomically(path, table.to_csv(index=False, lineterminator="\n"))
    return path


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
