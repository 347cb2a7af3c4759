"""Read published results from the data files in a study's package."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def read_published(package: str, name: str, *, text: tuple[str, ...] = ()) -> pd.DataFrame:
    """Read published results from the CSV file `data/<name>` of a package.

    Empty fields become "" in a column called `note`, and NaN in all other columns.

    Parameters
    ----------
    package
        The package of the study, e.g. "owtsweep.studies.hub".
    name
        Name of the file in the package's folder `data`.
    text
        Names of columns to read as text, although their values look like numbers.
    """
    import pandas as pd

    source = resources.files(package) / "data" / name
    with source.open(encoding="utf-8") as file:
        table = pd.read_csv(file, dtype=dict.fromkeys(text, str))
    if "note" in table:
        table["note"] = table["note"].fillna("").astype(str)
    return table
