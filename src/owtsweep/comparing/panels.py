"""Small multiples: the place and the title of each run's panel."""

from __future__ import annotations

from dataclasses import dataclass

from owtsweep.comparing.comparison import Comparison
from owtsweep.comparing.values import rank_values, show

#: Greatest number of panels that can be read.
MOST_PANELS = 30


@dataclass(frozen=True)
class Panels:
    """A grid of panels: first key across, second key downwards (with one key: rows of `WRAP`).

    `runs[row][column]` is the index of a run or None.
    """

    runs: list[list[int | None]]
    titles: list[list[str]]


WRAP = 4


def arrange(comparison: Comparison) -> Panels | None:
    """The panels for one or two keys; None for more keys, or more panels than can be read."""
    keys = comparison.keys
    if len(keys) > 2 or len(comparison.runs) > MOST_PANELS:
        return None
    places = [rank_values([run.values[key] for run in comparison.runs]) for key in keys]
    if len(keys) == 1:
        count = len(comparison.runs)
        columns = min(count, WRAP)
        place = {divmod(i, columns): i for i in range(count)}
        rows = -(-count // columns)
    else:
        columns, rows = (max(axis) + 1 for axis in places)
        if columns * rows > MOST_PANELS:
            return None
        place = {(row, column): i for i, (column, row) in enumerate(zip(*places, strict=True))}
    runs = [[place.get((row, column)) for column in range(columns)] for row in range(rows)]
    titles = [[_title(comparison, index) for index in line] for line in runs]
    return Panels(runs, titles)


def _title(comparison: Comparison, index: int | None) -> str:
    if index is None:
        return ""
    values = comparison.runs[index].values
    return "\n".join(f"{key} = {show(values[key])}" for key in comparison.keys)
