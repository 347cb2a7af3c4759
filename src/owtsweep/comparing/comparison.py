"""The types that the sweep package and the studies share to compare runs, and what differs in runs.

`owtsweep.sweep.compare` finds the runs, the keys in which the runs differ, and the pairs of runs to
compare: a `Comparison`. A study that is `Comparable` turns the comparison into `Findings`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd

from owtsweep.config import AnyConfig
from owtsweep.errors import printable
from owtsweep.results.conditions import Condition, Grid

__all__ = ["Aspects"]

#: Sections and keys that do not count as swept: they say on which grid, where and how to run.
NOT_SWEPT = frozenset(
    {"grid", "schemes", "baselines", "compute", "results", "name", "config_version"}
)
#: The name of the run folder, used as a key if no other key distinguishes two runs.
RUN = "run"
FIRST = "first run"


def show(value: object) -> str:
    """Return a configuration value as a user would type it in an override."""
    text = f"{value:.10g}" if isinstance(value, float) else str(write(value))
    return text if len(text) <= 30 else f"{text[:27]}..."


def write(value: object) -> int | float | str:
    """Return a value for a table: a number as it is, anything else as text, in JSON if need be."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    return printable(text)


def identify(value: object) -> str:
    """Return a text that identifies a value: equal values have equal texts."""
    return json.dumps(value, sort_keys=True, default=str)


def rank_values(values: Sequence[object]) -> list[int]:
    """Return the rank of each value: its index among the distinct values in order.

    If all are numbers, they are ordered by size, otherwise by their first appearance.
    """
    numeric = all(isinstance(write(value), int | float) for value in values)
    names: list[Any] = list(values) if numeric else [identify(value) for value in values]
    return [int(rank) for rank in pd.Series(names).factorize(sort=numeric)[0]]


@dataclass(frozen=True)
class Candidate:
    """One run of a comparison.

    name, hash: the name of the run's folder, and the hash of the run's configuration.
    config: the resolved configuration.
    rows: the sorted rows of the run's stored cases, including the failed ones.
    values: Swept configuration key -> this run's value, in the order of `Comparison.keys`.
    """

    name: str
    hash: str
    config: AnyConfig
    rows: pd.DataFrame
    values: Mapping[str, object]

    @property
    def shown(self) -> dict[str, str]:
        """Swept configuration key -> this run's value as text."""
        return {key: show(value) for key, value in self.values.items()}

    @property
    def written(self) -> dict[str, int | float | str]:
        """The run's values for tables, by swept key: numbers exactly, all others as whole texts."""
        return {key: write(value) for key, value in self.values.items()}

    @property
    def label(self) -> str:
        """The run's name in tables and figures: "key=value" for each swept key, side by side."""
        return " ".join(f"{key}={text}" for key, text in self.shown.items())


@dataclass(frozen=True)
class Pair:
    """Two runs to compare.

    first, second: indices of the runs in `Comparison.runs`.
    along: the swept key in which the two runs have neighbouring values; in all other keys they
        agree. If there is no such key, `first` is the first run of the whole comparison and `along`
        is "first run".
    """

    first: int
    second: int
    along: str


@dataclass(frozen=True)
class Comparison:
    """Runs of one study to compare; a swept key is a configuration key in which the runs differ.

    keys: the swept keys that distinguish the runs.
    following: Further swept keys, which are not shown because their values follow from those of
        `keys`.
    runs: the runs, in the order of their values of `keys`.
    pairs: the pairs of runs to compare.
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

    tables: Name -> table, to be written as `<name>.csv`.
    overview: Texts for the terminal, one row per run.
    notes: Sentences for the reader, e.g. on what was left out.
    report: Sections of the file `comparison.md`, in Markdown.
    figures: Files that have been written.
    origin: Sentences on the settings that all runs share and those that differ, for the head of the
        report and the terminal.
    """

    tables: Mapping[str, pd.DataFrame]
    overview: pd.DataFrame
    notes: tuple[str, ...] = ()
    report: str = ""
    figures: tuple[Path, ...] = ()
    origin: str = ""


def flatten(config: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    """Return dotted key -> value for nested mappings, e.g. "hme.mhe.horizon" -> 10.

    A list is a value, and so is an empty mapping. `prefix` is put before each key.
    """
    flat: dict[str, object] = {}
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def swept_keys(
    configs: Sequence[Mapping[str, object]], preferred: Sequence[str] = ()
) -> tuple[list[str], list[str]]:
    """Find a few keys that distinguish the configurations.

    Return two lists of dotted keys: the distinguishing keys, and the other keys in which the
    configurations differ. Keys are tried in order, those of `preferred`, which the user swept,
    first. A key goes into the second list if the keys of the first list determine its value:
    `tuning`, for example, changes dozens of keys.
    """
    flat = [
        {key: item for key, item in flatten(c).items() if key.split(".")[0] not in NOT_SWEPT}
        for c in configs
    ]
    keys = list(dict.fromkeys(key for config in flat for key in config))
    ids = {key: [identify(config.get(key)) for config in flat] for key in keys}
    differing = [key for key in keys if len(set(ids[key])) > 1]
    order = {key: place for place, key in enumerate(preferred)}
    # Top-level names (tuning, experiment) come first: they determine whole sections.
    differing.sort(key=lambda key: (order.get(key, len(order)), key.count(".") > 0))

    def count(names: Sequence[str]) -> int:
        """Return how many configurations some keys tell apart."""
        return len({tuple(ids[name][index] for name in names) for index in range(len(flat))})

    kept: list[str] = []
    for key in differing:
        if count([*kept, key]) > count(kept):
            kept.append(key)
    return kept, [key for key in differing if key not in kept]


def make_pairs(places: Sequence[Sequence[int]], keys: Sequence[str]) -> list[Pair]:
    """Return the pairs of runs to compare: two indices, and the key in which they differ.

    Two runs are a pair if they differ in one key only and have neighbouring values of this key. The
    first run is also paired with every other run. `places` has one sequence per run, with the rank
    (`rank_values`) of its value of each of `keys`.
    """
    pairs = []
    for axis, key in enumerate(keys):
        lines: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        for index, place in enumerate(places):
            rest = (*place[:axis], *place[axis + 1 :])
            lines.setdefault(rest, []).append((place[axis], index))
        for line in lines.values():
            ordered = [index for _, index in sorted(line)]
            pairs += [Pair(a, b, key) for a, b in pairwise(ordered)]
    made = {(pair.first, pair.second) for pair in pairs}
    pairs += [Pair(0, i, FIRST) for i in range(1, len(places)) if (0, i) not in made]
    return sorted(pairs, key=lambda pair: (pair.first, pair.second))


@dataclass(frozen=True, kw_only=True)
class Aspects:
    """The properties of a run that a comparison needs.

    conditions: the axes of the study's grid.
    grid: Name of a condition -> the run's values of it.
    schemes: names of the run's schemes, in the study's order.
    criterion, window: By which the run judges its schemes, e.g. "position" and "settled".
    pairing: Configuration key -> its value, for all keys that determine motion and noise. If two
        runs agree in all of them, the runs are compared record by record.
    boundary: names of two schemes: the first is expected to be better at small values of the last
        condition, the second at large values. None if no two schemes are expected to differ so.
    origin: Name of a setting -> its value in words, for titles: tuning, truth, records per cell,
        seed.
    score: What the number is called by which schemes are judged.
    beside: names of the run's baselines, which a comparison leaves out.
    best_of: for a run with expected values instead of records, a function that makes the table of
        best schemes of the run's rows, the values of the conditions that all compared runs have,
        the names of the schemes, and the criterion. None for a run with records.
    """

    conditions: tuple[Condition, ...]
    grid: Grid
    schemes: Sequence[str]
    criterion: str
    window: str
    pairing: Mapping[str, object]
    boundary: tuple[str, str] | None = None
    origin: Mapping[str, str] = field(default_factory=dict)
    score: str = "MSE"
    beside: Sequence[str] = ()
    best_of: Callable[[pd.DataFrame, Grid, Sequence[str], str], pd.DataFrame] | None = None

    @property
    def names(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.conditions]

    @property
    def size(self) -> int:
        """The number of cells."""
        return math.prod(len(self.grid[name]) for name in self.names)
