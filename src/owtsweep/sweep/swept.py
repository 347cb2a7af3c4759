"""Finds the keys in which runs differ, and the pairs of runs to compare."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from owtsweep.comparing.comparison import Pair, identify

#: Sections and keys that do not count as swept: they say on which grid, where and how to run.
NOT_SWEPT = frozenset(
    {"grid", "schemes", "baselines", "compute", "results", "name", "config_version"}
)
#: The name of the run folder, used as a key if no other key distinguishes two runs.
RUN = "run"
FIRST = "first run"


def flatten(config: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return dotted key -> value for nested mappings, e.g. "hme.mhe.horizon" -> 10.

    A list is a value, and so is an empty mapping. `prefix` is put before each key.
    """
    flat: dict[str, Any] = {}
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def swept_keys(
    configs: Sequence[Mapping[str, Any]], preferred: Sequence[str] = ()
) -> tuple[list[str], list[str]]:
    """Find a few keys that distinguish the configurations.

    Return two lists of dotted keys: the distinguishing keys, and the other keys in which the
    configurations differ. Keys are tried in order. A key is put into the first list unless the keys
    already in this list determine its value. For example, the key `tuning` changes dozens of keys.
    If `tuning` is in the first list, these keys are in the second list.

    Parameters
    ----------
    configs
        Configurations as plain mappings.
    preferred
        Dotted keys to try first: the keys that the user swept.
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
    kept: list[str] = []
    for key in differing:
        groups: dict[tuple[Hashable, ...], set[Hashable]] = {}
        for index, value in enumerate(ids[key]):
            groups.setdefault(tuple(ids[other][index] for other in kept), set()).add(value)
        if any(len(values) > 1 for values in groups.values()):
            kept.append(key)
    return kept, [key for key in differing if key not in kept]


def make_pairs(places: Sequence[Sequence[int]], keys: Sequence[str]) -> list[Pair]:
    """Return the pairs of runs to compare.

    Two runs are a pair if they differ in one key only and have neighbouring values of this key. The
    first run is also paired with every other run. A pair is the two runs' indices and the key.

    Parameters
    ----------
    places
        One sequence per run, with one number per key: the rank of the run's value among all values
        of the key, as `comparing.comparison.rank_values` computes it.
    keys
        The keys in which the runs differ.
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
