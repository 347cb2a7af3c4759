"""The errors of schemes over the values of one key, as table, figure and sentences take them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.conditions import Condition, Value

#: One of many is named; more than this many equally good schemes are counted.
MOST_NAMED = 3


@dataclass(frozen=True, kw_only=True)
class Errors:
    """The errors of schemes over the values of one key.

    along, values: the key that is varied, and its values in the order of tables and figure.
    schemes: the schemes in the contest.
    apart: Further ones that are drawn thin: baselines, or schemes whose estimates wait.
    cells: the cells of the grid in words, each with a panel and a table of its own.
    title, unit: which error it is, in words with its unit, and the unit.
    error: the errors, shape (schemes and then those apart, values, cells); NaN where there is none.
    best: which of them are best, or not told apart from the best, in the shape of `error`.
    best_scheme: the same among the schemes alone, shape (schemes, values, cells).
    interval: Ends of the 95 % confidence intervals, low and high; None: `error` has no scatter.
    bound: the Kalman bound at each value, shape (values,); None: there is none.
    facts: what holds at every value, e.g. the tuning and the sensors' properties that do not vary.
    further: Sentences of each cell that follow the one on its best scheme.
    notes, footnotes: Sentences that a reader of the errors needs, and those of the figure alone.
    table: the table vary.csv.
    """

    along: Condition
    values: tuple[Value, ...]
    schemes: tuple[str, ...]
    apart: tuple[str, ...] = ()
    cells: tuple[str, ...]
    title: str
    unit: str
    error: Array
    best: NDArray[np.bool_]
    best_scheme: NDArray[np.bool_]
    interval: tuple[Array, Array] | None = None
    bound: Array | None = None
    facts: tuple[str, ...] = ()
    further: tuple[tuple[str, ...], ...] = ()
    notes: tuple[str, ...] = ()
    footnotes: tuple[str, ...] = ()
    table: pd.DataFrame

    @property
    def names(self) -> tuple[str, ...]:
        return (*self.schemes, *self.apart)

    def show(self, error: float) -> str:
        """Return an error as text with its unit."""
        return f"{error:.3g} {self.unit}".strip()

    def name_best(self, value: int, cell: int) -> str:
        """Return the best of all in a cell at a value, as text; "-" if there is none."""
        return self._name(self.best[:, value, cell], value, cell)

    def name_best_scheme(self, value: int, cell: int) -> str:
        """Return the best schemes in a cell at a value, as text; "-" if there is none."""
        return self._name(self.best_scheme[:, value, cell], value, cell)

    def _name(self, chosen: NDArray[np.bool_], value: int, cell: int) -> str:
        numbers = [int(n) for n in chosen.nonzero()[0]]
        if len(numbers) > MOST_NAMED:
            least = min(numbers, key=lambda n: float(self.error[n, value, cell]))
            return f"{self.names[least]} or {len(numbers) - 1} others"
        return list_names([self.names[n] for n in numbers]) or "-"


def list_names(names: list[str]) -> str:
    """Return names as one text, e.g. "EKF, MKF or HME1"."""
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
