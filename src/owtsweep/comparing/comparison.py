"""The types that the sweep package and the studies share to compare runs.

`owtsweep.sweep.compare` finds the runs, the keys in which they differ, and the pairs to compare. A
study that is `Comparable` turns these into findings.
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
    """Return a value as a user would type it in an override; longer texts end after 27 letters."""
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
    """Return the place (0, 1, ...) of each value among the distinct values.

    Numbers are ordered by size. If a value is not a number, the order is that of first appearance.
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
        The run's hash.
    config
        The resolved configuration.
    rows
        The rows of the run's stored cases, including failed ones, sorted.
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
        """The run's values as texts, by swept key."""
        return {key: show(value) for key, value in self.values.items()}

    @property
    def written(self) -> dict[str, Any]:
        """The run's values for tables, by swept key: numbers exactly, all others as whole texts."""
        return {key: write(value) for key, value in self.values.items()}

    @property
    def label(self) -> str:
        """The name of the run in tables and figures: its swept keys and values as "key=value"."""
        return " ".join(f"{key}={text}" for key, text in self.shown.items())


@dataclass(frozen=True)
class Pair:
    """Two runs to compare.

    Attributes
    ----------
    first, second
        Indices of the runs in `Comparison.runs`.
    along
        The swept key in which the two runs have neighbouring values while all other keys are equal;
        or "first run" if the second run is compared with the first run of the comparison.
    """

    first: int
    second: int
    along: str


@dataclass(frozen=True)
class Comparison:
    """Runs of one study in the order of their swept values.

    Attributes
    ----------
    keys
        The swept configuration keys that distinguish the runs.
    following
        Further swept keys. Their values follow from those of `keys`, so they are not shown.
    runs
        The runs.
    pairs
        The pairs of runs to compare.
    """

    keys: tuple[str, ...]
    following: tuple[str, ...]
    runs: tuple[Candidate, ...]
    pairs: tuple[Pair, ...]

    def rank(self, key: str) -> list[int]:
        """Return the place (0, 1, ...) of each run's value of a key among the distinct values."""
        return rank_values([run.values[key] for run in self.runs])


@dataclass(frozen=True)
class Findings:
    """The results of a comparison.

    Attributes
    ----------
    tables
        Name -> table; each is written as `<name>.csv`.
    overview
        A table of texts for the terminal, one row per run, in the order of the runs.
    notes
        Sentences for the reader, e.g. on what was left out or which runs are not paired.
    report
        Sections of the file `comparison.md`, in Markdown.
    figures
        The figures' files, already written.
    """

    tables: Mapping[str, pd.DataFrame]
    overview: pd.DataFrame
    notes: tuple[str, ...] = ()
    report: str = ""
    figures: tuple[Path, ...] = ()


@runtime_checkable
class Comparable(Protocol):
    """A study whose runs can be compared."""

    def compare(
        self, comparison: Comparison, folder: Path, *, metadata: Mapping[str, str]
    ) -> Findings:
        """Compare runs, save the figures in `folder`, and return the findings.

        `metadata` are texts by name to store inside the figures' files.

        Raises
        ------
        InputError
            If these runs cannot be compared; then nothing has been written.
        """
        ...
