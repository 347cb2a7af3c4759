"""The conditions of a study: the named axes of its grid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Condition"]

#: A value of a condition: a number, or a text for a category.
Value = float | str
#: Condition -> its values. Texts are shown in the order in which they are listed here.
Grid = Mapping[str, Sequence[Value]]


@dataclass(frozen=True)
class Condition:
    """The description of a condition: one axis of a study's grid.

    name: the column in tables, and the key below `grid` in the configuration.
    label, unit: What to write on axes of figures, e.g. "motion amplitude" and "m".
    scale: How the condition's numbers are spaced: "linear" or "log".
    in_streams: whether each value of the condition has different random numbers.
    plural: the plural of the label, used in sentences; if it is "", the label with an s is used.
    enters: What the condition changes: "world" (what moves), "sensors" (what is measured of it),
        "knowledge" (what schemes know), or "scale" (a factor on what moves).
    """

    name: str
    label: str
    unit: str = ""
    scale: Literal["linear", "log"] = "linear"
    in_streams: bool = False
    plural: str = ""
    enters: Literal["world", "sensors", "knowledge", "scale"] = "world"

    @property
    def expands(self) -> bool:
        """Whether one computed result can serve all values of the condition.

        In the row of such a result (`results.superposition`) the condition is NaN. Only the last
        condition may expand.
        """
        return self.enters == "scale"

    @property
    def title(self) -> str:
        """The label with the unit, for an axis or a column, e.g. "motion amplitude (m)"."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    @property
    def word(self) -> str:
        """The condition's name as used in a sentence: with spaces instead of underscores."""
        return self.name.replace("_", " ")

    @property
    def values_word(self) -> str:
        """The plural of the condition's label, as used in a sentence, e.g. "amplitudes"."""
        return self.plural or f"{self.label}s"

    def show(self, value: Value) -> str:
        """Return a value of the condition as text, e.g. "0.2 m"; texts get no unit."""
        shown = show_value(value)
        return f"{shown} {self.unit}" if self.unit and not isinstance(value, str) else shown


def show_value(value: Value) -> str:
    """Return a value as text, without its unit."""
    return value if isinstance(value, str) else f"{value:g}"


def require_usable(conditions: Sequence[Condition]) -> None:
    """Raise `InputError` unless tables can be made with these conditions.

    There is one at least, no two have one name, and only the last expands.
    """
    names = [condition.name for condition in conditions]
    if not names or len(set(names)) < len(names):
        raise InputError(f"conditions: {names}; a study has one or more, each with its own name")
    for condition in conditions[:-1]:
        if condition.expands:
            raise InputError(
                f"conditions: {condition.name} expands and is not the last condition; put "
                f"{condition.name} at the end, and let no other condition expand"
            )


def find_only_cell(grid: Grid, section: str = "grid") -> dict[str, Value]:
    """Return condition -> value of a grid (in the configuration's `section`) that has one cell.

    Raise `InputError` if a condition has several values.
    """
    for name, values in grid.items():
        if len(values) != 1:
            raise InputError(
                f"{section}.{name}: {len(values)} values, and a record is of one cell; choose one "
                f"value, e.g. {section}.{name}=[{show_value(values[0])}]"
            )
    return {name: values[0] for name, values in grid.items()}


def order_values(column: object, listed: Iterable[Value] = ()) -> list[Value]:
    """Return the distinct values of a column: numbers by size, texts in the order of `listed`.

    Texts that are not listed come last, alphabetically.
    """
    distinct: list[Value] = np.unique(np.asarray(column)).tolist()
    place = {value: number for number, value in enumerate(listed)}
    if distinct and isinstance(distinct[0], str):
        distinct.sort(key=lambda value: (place.get(value, len(place)), value))
    return distinct


def select(table: pd.DataFrame, at: Mapping[str, Value]) -> pd.DataFrame:
    """Return the rows of a table with given values of conditions, condition -> value."""
    for name, value in at.items():
        table = table[table[name] == value]
    return table


def spread(table: pd.DataFrame, grid: Grid) -> pd.DataFrame:
    """Repeat each row without a value of a condition of `grid` at every value that it has there."""
    import pandas as pd

    for name, values in grid.items():
        free = table[name].isna()
        if free.any():
            every = pd.DataFrame({name: values}, dtype=float)
            repeated = table[free].drop(columns=name).merge(every, how="cross")
            table = pd.concat([table[~free], repeated[table.columns]], ignore_index=True)
    return table


def sort_lines(table: pd.DataFrame, order: Mapping[str, Sequence[object]]) -> pd.DataFrame:
    """Return a table sorted by some of its columns.

    `order` maps these columns, the most important first, to all values in the wanted order.
    """
    return table.sort_values(
        list(order), kind="stable", ignore_index=True,
        key=lambda column: column.map({v: i for i, v in enumerate(order[str(column.name)])}),
    )  # fmt: skip
