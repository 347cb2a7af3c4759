"""The types by which the sweep room and the studies agree on what a comparison of runs is.

`owtsweep.sweep.compare` finds runs, keys and pairs without knowing what they mean. A study that is
`Comparable` turns them into findings.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from owtsweep.comparing.values import show

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Candidate:
    """One run of a comparison.

    Attributes
    ----------
    name
        Its folder's name.
    hash
        The run's hash.
    config
        The resolved configuration.
    rows
        The rows of its stored cases, failed ones included, sorted.
    values
        Swept key -> this run's value, in the order of `Comparison.keys`.
    """

    name: str
    hash: str
    config: Any
    rows: pd.DataFrame
    values: Mapping[str, Any]

    @property
    def label(self) -> str:
        """The run by its swept values."""
        return " ".join(f"{key}={show(value)}" for key, value in self.values.items())


@dataclass(frozen=True)
class Pair:
    """Two runs to compare, by their index; `along` says why these two.

    `along` is the swept key in which they have neighbouring values while all others are equal, or
    "first run" if `first` is merely the first of the comparison.
    """

    first: int
    second: int
    along: str


@dataclass(frozen=True)
class Comparison:
    """Runs of one study in the order of their swept values.

    `keys` tell the runs apart. `following` change with them and need not be shown.
    """

    keys: tuple[str, ...]
    following: tuple[str, ...]
    runs: tuple[Candidate, ...]
    pairs: tuple[Pair, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Findings:
    """The results of a comparison.

    Attributes
    ----------
    tables
        Name -> table; each is written as `<name>.csv`.
    overview
        One row per run, in their order, texts only: what the terminal shows.
    notes
        What a reader must know: what was left out, what is not paired.
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
        """Compare runs; figures go into `folder` and carry `metadata`.

        Raises
        ------
        InputError
            If these runs have nothing in common; nothing has been written then.
        """
        ...
