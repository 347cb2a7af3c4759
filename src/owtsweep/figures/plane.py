"""The axes of a map: one condition on the horizontal axis, and one on the vertical axis."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.results.conditions import Condition, Grid, Value, order_values, show_value

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: A value beyond the map is drawn this many cells outside the centres of the edge cells.
EDGE = 0.5
#: A cell of a map: its row of best_scheme.csv, a value of some type per column, as pandas gives it.
Row = Mapping[Hashable, Any]
#: Letters that fit beside a line of cells.
LETTERS_PER_LINE = 8


@dataclass(frozen=True)
class Plane:
    """The axes of a map. The cell in column i and line j has its centre at x = i and y = j, from 0.

    `across`, `columns`: the condition on the horizontal axis, and its values from left to right.
    `upwards`, `lines`: the condition on the vertical axis, and its values from bottom to top; None
    and a single "" if the map has a single line.
    """

    across: Condition
    columns: list[Value]
    upwards: Condition | None
    lines: list[Value]

    @classmethod
    def of(cls, table: pd.DataFrame, conditions: Sequence[Condition]) -> Plane:
        """Make the axes of a map with all values that the conditions have in a table.

        Of more than two conditions, the axes show those with several values; conditions with one
        value fill the axes that are left. Raise `InputError` if more than two conditions have
        several values.
        """
        columns = {condition.name: table[condition.name] for condition in conditions}
        grid = {name: order_values(column, column.unique()) for name, column in columns.items()}
        return cls.over(conditions, grid)

    @classmethod
    def over(cls, conditions: Sequence[Condition], grid: Grid) -> Plane:
        """Make the axes of a map as `of` does, but with the values in `grid`."""
        varied = [condition for condition in conditions if len(grid[condition.name]) > 1]
        if len(varied) > 2:
            names = ", ".join(condition.name for condition in varied)
            raise InputError(
                f"map: {names} all have several values, and a map shows two conditions; give "
                "others one value each, or sweep them with --multirun"
            )
        rest = [condition for condition in conditions if condition not in varied]
        shown = sorted([*varied, *rest][:2], key=list(conditions).index)
        across, upwards = shown[0], shown[1] if len(shown) > 1 else None
        lines: list[Value] = list(grid[upwards.name]) if upwards else [""]
        return cls(across, list(grid[across.name]), upwards, lines)

    def list_off(self, conditions: Sequence[Condition]) -> list[str]:
        """Return the names of those of some conditions that are no axis of the map."""
        return [each.name for each in conditions if each not in (self.across, self.upwards)]

    @property
    def size(self) -> int:
        """The number of cells of the map."""
        return len(self.columns) * len(self.lines)

    def place(self, row: Row) -> tuple[int, int]:
        """Return the column and the line of the cell with the values in `row`, by condition."""
        line = self.lines.index(row[self.upwards.name]) if self.upwards else 0
        return self.columns.index(row[self.across.name]), line

    def height_of(self, values: Array) -> Array:
        """Return the y coordinates on the map for values of the condition on the vertical axis.

        Between the centres of two lines of cells, y is interpolated on the condition's scale,
        linear or logarithmic. A value beyond the map is placed at its edge; NaN stays NaN. If the
        map has one line, y is 0 for all numbers.
        """
        return _place_between(values, self.lines, self.upwards.scale if self.upwards else "")

    def column_of(self, values: Array) -> Array:
        """Return x coordinates for values of the horizontal condition, as `height_of` does."""
        return _place_between(values, self.columns, self.across.scale)

    @property
    def side_label(self) -> str:
        """The label of the vertical axis, in lines that fit beside the map."""
        title = self.upwards.title if self.upwards else ""
        return fill(title, max(20, LETTERS_PER_LINE * len(self.lines)))

    def label_axes(self, axes: Axes) -> None:
        """Set limits, ticks and labels of both axes."""
        axes.set(xlim=(-0.5, len(self.columns) - 0.5), ylim=(-0.5, len(self.lines) - 0.5))
        axes.set_xticks(range(len(self.columns)), [show_value(value) for value in self.columns])
        axes.set_yticks(range(len(self.lines)), [show_value(value) for value in self.lines])
        axes.set(xlabel=self.across.title, ylabel=self.side_label)


def _place_between(values: Array, centres: Sequence[Value], scale: str) -> Array:
    """Return coordinates of values between the centres of cells, which lie at 0, 1, 2, ...

    A value beyond the map is placed at its edge; NaN stays NaN.
    """
    if len(centres) == 1:
        return np.where(np.isnan(values), np.nan, 0.0)
    places = np.asarray(centres, dtype=float)
    numbers = np.arange(len(places), dtype=float)
    if scale == "log":
        values, places = np.log(np.maximum(values, 1e-12)), np.log(places)
    steps = np.diff(places)
    ends = places[0] - EDGE * steps[0], places[-1] + EDGE * steps[-1]
    padded = np.concatenate([ends[:1], places, ends[1:]])
    heights = np.concatenate([[-EDGE], numbers, [numbers[-1] + EDGE]])
    return np.asarray(np.interp(values, padded, heights))
