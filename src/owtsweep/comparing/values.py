"""The display and the order of the values of swept keys."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any


def show(value: Any) -> str:
    """A value as a user would type it in an override, shortened to fit a title."""
    if isinstance(value, float):
        return f"{value:.10g}"
    text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
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
