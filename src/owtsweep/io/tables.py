"""Writes and reads the tables of a run: CSV files whose numbers are read back exactly."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_bytes

if TYPE_CHECKING:
    import pandas as pd

#: Most bytes of a table.
MOST_BYTES = 1_000_000_000
_QUOTED = re.compile(rb'"[^"]*"')


def dump_tables(tables: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """Return file name (`<name>.csv`) -> text, for each table without its index."""
    # pandas writes a float as `repr` does: the shortest text that reads back as the same number.
    return {
        f"{name}.csv": table.to_csv(index=False, lineterminator="\n")
        for name, table in tables.items()
    }


def write_table(folder: Path, name: str, table: pd.DataFrame) -> Path:
    """Write a table to `<name>.csv` in a folder, whole or not at all, without its index.

    Raise `OSError` if the file system refuses the file.
    """
    path = folder / f"{name}.csv"
    write_atomically(path, dump_tables({name: table})[path.name])
    return path


def read_table(folder: Path, name: str) -> pd.DataFrame:
    """Read the table `<name>.csv` in the folder of a run.

    An empty field becomes NaN in a column of numbers, or in an empty one, and "" in one of texts.
    Raise `InputError` if the folder does not hold this file, or the file is damaged.
    """
    path = folder / f"{name}.csv"
    if not os.path.lexists(path):
        names = sorted(other.stem for other in folder.glob("*.csv"))
        hint = f"it has {', '.join(names)}" if names else "it has none yet: finish its sweep"
        raise InputError(f"{name}: the run {folder} has no such table; {hint}")
    data = read_bytes(path, MOST_BYTES)
    try:
        table = _parse(data)
    except ValueError as error:  # errors of pandas are ValueErrors
        raise InputError(f"{path}: this is no table; run its sweep again") from error
    text = table.select_dtypes(exclude=["number", "bool"]).columns
    return table.fillna(dict.fromkeys(text, ""))


def _parse(data: bytes) -> pd.DataFrame:
    import pandas as pd

    # Not pandas' Arrow engine: if a quote never ends, it reads half a table as one field; and it
    # guesses dates. A scheme may be named "NA", so only an empty field is a missing value.
    table: pd.DataFrame = pd.read_csv(
        BytesIO(data),
        low_memory=False,
        keep_default_na=False,
        na_values=[""],
        float_precision=None if _is_exact(pd.__version__) else "round_trip",
    )
    # pandas accepts damaged tables: it fills short lines, takes a surplus field as the row's name,
    # and renames columns of equal names.
    commas = _QUOTED.sub(b"", data).count(b",")
    header = BytesIO(data).readline()
    names = pd.read_csv(BytesIO(header), header=None, dtype=str, keep_default_na=False).iloc[0]
    if commas != (len(table) + 1) * (len(names) - 1) or list(names) != list(table.columns):
        raise ValueError("its lines differ in length, or two columns have one name")
    if b"\0" in data:
        raise ValueError("it holds null bytes")
    return table if len(table) else table.astype(float)


def _is_exact(version: str) -> bool:
    """Return whether a version of pandas reads numbers exactly without an option: from 3.1 on."""
    major, minor = version.split(".")[:2]
    return (int(major), int(minor)) >= (3, 1)


def read_map(run: Path) -> pd.DataFrame | None:
    """Return the lines of a run's best_scheme.csv by its first criterion; None if there are none.

    Then no case has succeeded, or the study makes no such table.
    """
    try:
        best = read_table(run, "best_scheme")
    except InputError:
        return None
    if best.empty or not {"criterion", "verdict", "error_best"} <= {*best.columns}:
        return None
    first: pd.DataFrame = best[best["criterion"] == best["criterion"].iloc[0]]
    return first
