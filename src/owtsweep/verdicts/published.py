"""Reads published results from the data files of a study."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def read_published(package: str, name: str, *, text: tuple[str, ...] = ()) -> pd.DataFrame:
    """Read `data/<name>` of a package; an empty `note` is empty text.

    Parameters
    ----------
    package
        The package of the study, e.g. "owtsweep.studies.hub".
    text
        Columns that are text although they look like numbers.
    """
    import pandas as pd

    source = resources.files(package) / "data" / name
    with source.open(encoding="utf-8") as file:
        table = pd.read_csv(file, dtype=dict.fromkeys(text, str))
    if "note" in table:
        table["note"] = table["note"].fillna("").astype(str)
    return table
