"""The types that the sweep package and the studies share to compare runs.

`owtsweep.sweep.compare` finds the runs, the keys in which the runs differ, and the pairs of runs to
compare: a `Comparison`. A study that is `Comparable` turns the comparison into `Findings`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from owtsweep.errors import printable

if TYPE_CHECKING:
    import pandas as pd


def show(value: Any) -> str:
    """Return a configuration value as a user would type it in an override.

    A text of more than 30 letters is cut after 27 letters, and "..." is appended.
    """
    if isinstance(value, float):
        return f"{value:.10g}"
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    text = printable(text)
    return text if len(text) <= 30 else f"{text[:27]}..."


def write(value: Any) -> int | float | str:
    """Return a value for a table: a number as it is, anything else as text, in JSON if need be."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    return printable(text)


def identify(value: Any) -> str:
    """Return a text that identifies a value: equal values have equal texts."""
    return json.dumps(value, sort_keys=True, default=str)


def rank_values(values: Sequence[Any]) -> list[int]:
    """Return the rank of each value: its index, from 0, among the distinct values in order.

    If all values are numbers, the distinct values are ordered by size, otherwise by their first
    appearance. Equal values have equal ranks.
    """
    numbers = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
    distinct = {identify(value): value for value in values}
    axis = sorted(distinct, key=lambda i: distinct[i]) if numbers else list(distinct)
    return [axis.index(identify(value)) for value in values]


@dataclass(frozen=True)
class Candidate:
    """One run of a comparison.

    Attributes
    ----------
    name
        The name of the run's folder.
    hash
        The hash of the run's configuration.
    config
        The resolved configuration.
    rows
        The sorted rows of the run's stored cases, including the failed cases.
    values
        Swept configuration key -> this run's value, in the order of `Comparison.keys`.
    """

    name: str
    hash: str
    config: Any
    rows: pd.DataFrame
    values: Mapping[str, Any]

    @property
    def shown(self) -> dict[str, str]:
        """Swept configuration key -> this run's value as text."""
        return {key: show(value) for key, value in self.values.items()}

    @property
    def written(self) -> dict[str, Any]:
        """The run's values for tables, by swept key: numbers exactly, all others as whole texts."""
        return {key: write(value) for key, value in self.values.items()}

    @property
    def label(self) -> str:
        """The run's name in tables and figures: "key=value" for each swept key, side by side."""
        return " ".join(f"{key}={text}" for key, text in self.shown.items())


@dataclass(frozen=True)
class Pair:
    """Two runs to compare.

    Attributes
    ----------
    first, second
        Indices of the runs in `Comparison.runs`.
    along
        The swept key in which the two runs have neighbouring values; in all other keys they agree.
        If there is no such key, `first` is the first run of the whole comparison and `along` is
        "first run".
    """

    first: int
    second: int
    along: str


@dataclass(frozen=True)
class Comparison:
    """Runs of one study to compare; a swept key is a configuration key in which the runs differ.

    Attributes
    ----------
    keys
        The swept keys that distinguish the runs.
    following
        Further swept keys, which are not shown because their values follow from those of `keys`.
    runs
        The runs, in the order of their values of `keys`.
    pairs
        The pairs of runs to compare.
    """

    keys: tuple[str, ...]
    following: tuple[str, ...]
    runs: tuple[Candidate, ...]
    pairs: tuple[Pair, ...]

    def rank(self, key: str) -> list[int]:
        """Return, for each run, the rank (from 0) of its value of a swept key among all runs.

        Numbers are ordered by size, other values by first appearance. Equal values have equal
        ranks.
        """
        return rank_values([run.values[key] for run in self.runs])


@dataclass(frozen=True)
class Findings:
    """The results of a comparison.

    Attributes
    ----------
    tables
        Name -> table; each table is to be written as `<name>.csv`.
    overview
        A table of texts for the terminal, one row per run, in the order of the runs.
    notes
        Sentences for the reader, e.g. on what was left out.
    report
        Sections of the file `comparison.md`, in Markdown.
    figures
        Paths of the figures' files, which have been written.
    origin
        Sentences on where the numbers come from: settings that all runs share, and settings that
        differ. They stand at the head of the report and above the terminal's table.
    """

    tables: Mapping[str, pd.DataFrame]
    overview: pd.DataFrame
    notes: tuple[str, ...] = ()
    report: str = ""
    figures: tuple[Path, ...] = ()
    origin: str = ""


@runtime_checkable
class Comparable(Protocol):
    """The interface of a study whose runs can be compared."""

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """Compare runs, write figures into `folder`, and return tables, figures and text.

        Parameters
        ----------
        comparison
            The runs, and the pairs of runs to compare.
        folder
            Folder for the figures.
        metadata
            Name -> text; these texts are stored inside the files of the figures.

        Raises
        ------
        InputError
            If these runs cannot be compared. In this case nothing is written.
        """
        ...
