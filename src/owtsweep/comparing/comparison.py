"""The types that the sweep package and the studies share to compare runs.

`owtsweep.sweep.compare` finds runs, keys and pairs without knowing what they mean. A study that is
`Comparable` turns them into findings.
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
    """A value as a user would type it in an override, shortened to fit a title."""
    if isinstance(value, float):
        return f"{value:.10g}"
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    text = printable(text)
    return text if len(text) <= 30 else f"{text[:27]}..."


def identify(value: Any) -> str:
    """A text that identifies a value: equal values have equal texts."""
    return json.dumps(value, sort_keys=True, default=str)


def rank_values(values: Sequence[Any]) -> list[int]:
    """The place of each value on its axis: numbers by size, others by first appearance."""
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
        The rows of its stored cases, including failed ones, sorted.
    values
        Swept key -> this run's value, in the order of `Comparison.keys`.
    """

    name: str
    hash: str
    config: Any
    rows: pd.DataFrame
    values: Mapping[str, Any]

    @property
    def shown(self) -> dict[str, str]:
        """Swept key -> this run's value as text."""
        return {key: show(value) for key, value in self.values.items()}

    @property
    def label(self) -> str:
        """The name of the run, made from its swept values."""
        return " ".join(f"{key}={text}" for key, text in self.shown.items())


@dataclass(frozen=True)
class Pair:
    """Two runs to compare, by their indices; `along` says why they form a pair.

    `along` is the swept key in which they have neighbouring values while all other keys are equal,
    or "first run" if `first` is only the first run of the comparison.
    """

    first: int
    second: int
    along: str


@dataclass(frozen=True)
class Comparison:
    """Runs of one study in the order of their swept values.

    `keys` are the swept keys that distinguish the runs. Those in `following` change with them and
    need not be shown.
    """

    keys: tuple[str, ...]
    following: tuple[str, ...]
    runs: tuple[Candidate, ...]
    pairs: tuple[Pair, ...]

    def rank(self, key: str) -> list[int]:
        """The place of each run on the axis of a key."""
        return rank_values([run.values[key] for run in self.runs])


@dataclass(frozen=True)
class Findings:
    """The results of a comparison.

    Attributes
    ----------
    tables
        Name -> table; each is written as `<name>.csv`.
    overview
        One row of texts per run, in the order of the runs; shown in the terminal.
    notes
        Notes for the reader, e.g. what was left out or is not paired.
    report
        Sections of `comparison.md`, Markdown.
    figures
        The files drawn.
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
        """Compare runs; figures are saved in `folder` with `metadata`.

        Raises
        ------
        InputError
            If these runs have nothing in common; then nothing has been written.
        """
        ...
