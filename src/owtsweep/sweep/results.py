"""The results of a run by tuning: rows and tables, and how those of several tunings are joined."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep.config import Config
from owtsweep.sweep.gather import join_tunings

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Results:
    """The results of a run of one tuning.

    Attributes
    ----------
    config
        The run's configuration.
    rows
        The rows of the run's cases, sorted.
    tables
        The tables that the study makes of the rows, by name.
    """

    config: Config
    rows: pd.DataFrame
    tables: dict[str, pd.DataFrame]


def join_rows(stored: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return the rows of all tunings; with several, `tuning` is their first column."""
    return stored[""] if "" in stored else join_tunings(stored)


def join_tables(results: Mapping[str, Results]) -> dict[str, pd.DataFrame]:
    """Return the tables of all tunings by name; with several, `tuning` is their first column."""
    import pandas as pd

    names = dict.fromkeys(name for part in results.values() for name in part.tables)
    if "" in results:
        return results[""].tables
    joined = {}
    for name in names:
        parts = {tuning: part.tables[name] for tuning, part in results.items()}
        whole = pd.concat(parts.values(), ignore_index=True)
        tunings = [tuning for tuning, part in parts.items() for _ in range(len(part))]
        whole.insert(0, "tuning", tunings)
        joined[name] = whole
    return joined
