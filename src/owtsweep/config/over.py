"""The key `over`: an axis that nobody knows, on which the truth departs from what schemes are told.

`over={world: [nominal, outliers_1], weights: [3, 1]}` names worlds of the study; `over={KEY:
[values]}` gives a key of the truth other values, each of which is a world.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from owtsweep.errors import InputError, require

Over = Mapping[str, Sequence[Any]]

#: The world in which the truth is what schemes are told. It is always computed.
NOMINAL = "nominal"
#: The names in `over` that are no keys of the configuration.
WORLD, WEIGHTS = "world", "weights"
#: Each is checked as a configuration of its own, also when a stranger's run is read.
MOST_WORLDS = 100


def find_axis(over: Over) -> tuple[str, Sequence[Any]]:
    """Return `world` or the key that departs, and its values.

    Raise `InputError` unless there is one, with values of which none stands there twice.
    """
    axes = {name: values for name, values in over.items() if name != WEIGHTS}
    if len(axes) != 1:
        raise InputError(
            f"over: it has {len(axes)} axes ({', '.join(axes)}); give one, e.g. "
            "over={world: [nominal]}"
        )
    ((axis, values),) = axes.items()
    require(
        1 <= len(values) <= MOST_WORLDS,
        f"over.{axis}: it has {len(values)} values; give 1 to {MOST_WORLDS}",
    )
    shown = [str(value) for value in values]
    for name in shown:
        require(shown.count(name) == 1, f"over.{axis}: {name} stands there twice; list it once")
    return axis, values


def name_worlds(over: Over) -> list[str]:
    """Return the names of the worlds over which a regret is."""
    axis, values = find_axis(over)
    return [str(value) if axis == WORLD else f"{axis}={value}" for value in values]


def list_weights(over: Over) -> list[float]:
    """Return the weights of the worlds, whose sum is 1; equal ones unless they are given.

    Raise `InputError` unless there is one weight above zero for each world.
    """
    count = len(find_axis(over)[1])
    given = over.get(WEIGHTS, [1.0] * count)
    usable = [
        isinstance(weight, int | float) and not isinstance(weight, bool) and 0.0 < weight < math.inf
        for weight in given
    ]
    require(
        len(given) == count and all(usable),
        f"over.{WEIGHTS}: {list(given)} does not fit {count} worlds; give {count} numbers above "
        "zero, or leave it out for equal weights",
    )
    return [float(weight) / math.fsum(given) for weight in given]
