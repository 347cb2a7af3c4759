"""Tables of scores, by which claims are judged: one line per cell, record and value."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.results.boundary import (
    divide_crossings,
    find_boundary,
    split_cells,
    subtract_schemes,
)
from owtsweep.results.conditions import Condition, Grid
from owtsweep.results.cube import Cube
from owtsweep.verdicts.inference import Estimate

#: A value of a column that says what a score is of.
Value = str | bool | float
#: A cell: column -> its value. A selection: column -> its values, of which all combinations count.
Cell = dict[str, Value]
Selection = dict[str, tuple[Value, ...]]
#: A place: the values of all conditions of a run but the last.
Place = tuple[Value, ...]
#: Numbers of claims and of tables are equal if they agree to this many decimal places.
DIGITS = 9
#: In a selection: all values that the table has.
ALL = "*"


def tidy(value: object) -> Value:
    """Return a value as cells have it: numbers rounded, but for what is true or false."""
    if isinstance(value, str):
        return value

    if isinstance(value, bool | np.bool_):
        return bool(value)
    assert isinstance(value, int | float | np.number), value
    return round(float(value), DIGITS)


@dataclass(frozen=True)
class Boundary(Estimate):
    """The value of the last condition at which two schemes are equally good.

    Without one, it is NaN, and `wins` names the scheme that is better at every value, or "neither"
    if the means cross twice or the other way round; else `wins` is "".
    """

    wins: str = ""


@dataclass(frozen=True)
class RunRows:
    """The rows of a run, of which boundaries are found, in one window.

    `rows` and `conditions` are as `Run.cases` and `Study.conditions` return them. The last
    condition expands.
    """

    rows: pd.DataFrame
    conditions: Sequence[Condition]
    window: str
    _found: dict[tuple[str, ...], dict[Place, Boundary]] = field(default_factory=dict, repr=False)

    def find_boundaries(self, schemes: tuple[str, str], measure: str) -> dict[Place, Boundary]:
        """Return the boundaries by the values of all conditions but the last; {} without rows.

        The first scheme is better below the boundary, the second above.
        """
        key = (*schemes, measure)
        if key in self._found:
            return self._found[key]
        difference, found = self._subtract(schemes, measure), self._found.setdefault(key, {})
        table = pd.DataFrame() if difference is None else find_boundary(difference, schemes)
        for row in table.to_dict("records"):
            place = tuple(tidy(row[condition.name]) for condition in self.conditions[:-1])
            label = f"boundary at {self.tell(place)}"
            if row["wins"] == "neither":
                label += " (none: the means cross twice, or the other way round)"
            elif row["wins"]:
                label += f" (none: {row['wins']} is better at every {self.conditions[-1].word})"
            numbers = row["boundary"], row["ci_low"], row["ci_high"]
            found[place] = Boundary(label, *numbers, row["wins"])
        return found

    def divide(
        self, places: tuple[Place, Place], schemes: tuple[str, str], measure: str
    ) -> Estimate | None:
        """Return the boundary at one place over that at another; None without rows."""
        difference = self._subtract(schemes, measure)
        cells = {} if difference is None else split_cells(difference)
        tidied = {tuple(map(tidy, cell)): (cell, products) for cell, products in cells.items()}
        if not all(place in tidied for place in places):
            return None
        name = f"boundary at {self.tell(places[0])} over that at {self.tell(places[1])}"
        return Estimate(name, *divide_crossings(*(tidied[place] for place in places)))

    def _subtract(self, schemes: tuple[str, str], measure: str) -> pd.DataFrame | None:
        try:
            return subtract_schemes(self.rows, self.conditions, schemes, measure, self.window)
        except InputError:  # a scheme is missing, or cases run directly: they have no products
            return None

    def tell(self, place: Place) -> str:
        """Return the values of all conditions but the last in words."""
        pairs = zip(self.conditions[:-1], place, strict=True)
        return ", ".join(condition.show(value) for condition, value in pairs)


@dataclass(frozen=True)
class ScoreTable:
    """Scores of several records.

    table: Long form. Columns: those that say what a value is of (scenario, conditions, scheme,
        quantity, measure ...), replicate, value. No field is empty.
    run: the rows that the table was made of, if they hold for all values of the last condition.
    """

    table: pd.DataFrame
    run: RunRows | None = None

    @classmethod
    def of_rows(
        cls, rows: pd.DataFrame, conditions: Sequence[Condition], grid: Grid, window: str
    ) -> ScoreTable:
        """Make the scores of a run: columns scheme, the conditions, measure, replicate, value.

        Of `grid` only the values of a last condition that expands are needed.
        """
        inside = rows[rows["window"] == window]
        cube = Cube.of_rows(inside, list(inside["scheme"].unique()), conditions, grid)
        run = RunRows(rows, conditions, window) if conditions[-1].expands else None
        return cls(cube.to_table().drop(columns="window"), run)

    @property
    def records(self) -> int:
        return int(self.table["replicate"].nunique())

    @cached_property
    def columns(self) -> list[str]:
        """The names of the columns that say what a value is of."""
        return [str(name) for name in self.table if name not in ("replicate", "value")]

    @cached_property
    def _by_cell(self) -> dict[tuple[Value, ...], pd.Series[float]]:
        groups = self.table.set_index("replicate").sort_index(kind="stable")
        by_columns = groups.groupby(self.columns, sort=False, observed=True)["value"]
        return {
            tuple(tidy(value) for value in (key if isinstance(key, tuple) else (key,))): values
            for key, values in by_columns
        }

    @cached_property
    def _only(self) -> dict[str, Value]:
        values = [set(column) for column in zip(*self._by_cell, strict=True)]
        pairs = zip(self.columns, values, strict=bool(values))
        return {name: next(iter(found)) for name, found in pairs if len(found) == 1}

    def list_cells(
        self, selection: Selection, *, free: Collection[str] = ()
    ) -> list[dict[str, Value]]:
        """Return the cells of a selection, whether the table has them or not.

        The last of the selected columns varies first. Columns in `free` need no value. Raise
        `InputError` if another column is left out that has several values.
        """
        left = [name for name in self.columns if name not in selection and name not in free]
        for name in left:
            require(
                name in self._only or not self._by_cell,
                f"claims: {name} has several values in these scores; select some",
            )
        listed = {
            name: self._list_values(name, selection) if values == (ALL,) else values
            for name, values in selection.items()
        }
        listed |= {name: (self._only[name],) for name in left if name in self._only}
        return [dict(zip(listed, values, strict=True)) for values in product(*listed.values())]

    def _list_values(self, column: str, selection: Selection) -> tuple[Value, ...]:
        """Return the values of a column beside what else is selected; ("*",) if there are none."""
        fixed = {name: values for name, values in selection.items() if values != (ALL,)}
        cells = (dict(zip(self.columns, key, strict=True)) for key in self._by_cell)
        beside = [c for c in cells if all(c.get(n) in values for n, values in fixed.items())]
        return tuple(dict.fromkeys(cell[column] for cell in beside)) or (ALL,)

    def find(self, cells: Sequence[Cell]) -> list[Array] | None:
        """Return the values of cells in the records that have all of them.

        One array of shape (records,) per cell, all in the same order of records; None if a cell has
        no values, or if no record has all.
        """
        keys = [tuple(cell.get(name, "") for name in self.columns) for cell in cells]
        if not all(key in self._by_cell for key in keys):
            return None
        found = [self._by_cell[key] for key in keys]
        require(
            all(series.index.is_unique for series in found),
            "claims: these scores have two values of one record in one cell",
        )
        if all(series.index.equals(found[0].index) for series in found):
            return [series.to_numpy(dtype=float) for series in found]  # as a rule; a join is slow
        shared = pd.concat(found, axis=1, join="inner")
        return list(shared.to_numpy(dtype=float).T) if len(shared) else None
