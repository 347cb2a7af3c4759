"""Runs schemes on the same records under one tuning after another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.base.blocks import Readied, Records
from owtsweep.studies.base.contest import AnyContest
from owtsweep.studies.base.declaration import AnyDeclaration

#: Most cells of a map that are searched over; of a larger map, its corners and its middle.
MOST_CELLS = 6


def choose_cells(contest: AnyContest, config: Any) -> list[Cell]:
    """Return the cells of a map, or of a large map its four corners and its middle."""
    cells = contest.list_cells(config)
    if len(cells) <= MOST_CELLS:
        return cells
    grid = contest.get_grid(config)
    corners = product(*((values[0], values[-1]) for values in grid.values()))
    middle = tuple(values[len(values) // 2] for values in grid.values())
    wanted = [*corners, middle]
    return [cell for cell in cells if tuple(cell[axis] for axis in grid) in wanted]


class Training:
    """Some records of some cells, which are made once."""

    def __init__(
        self, declaration: AnyDeclaration, config: Any, cells: Sequence[Cell], seed: int, count: int
    ) -> None:
        self._declaration, self._seed, self._tried = declaration, seed, 0
        self._config = changed(config, seed=seed)
        self._records = [(cell, Records(declaration, self._config, range(count))) for cell in cells]

    def run(self, config: Any, scheme: str, measure: str) -> Array:
        """Run a scheme under the tuning of `config`; return a measure, shape (cells, records).

        It is NaN where the scheme has no estimates.
        """
        declaration = self._declaration
        self._tried += 1  # a name for each tuning: what schemes know is kept by it
        tuned = changed(config, seed=self._seed, tuning=f"trial {self._tried}")
        chosen = next(s for s in declaration.schemes.choose(tuned) if s.name == scheme)
        ready = Readied(declaration, chosen)
        values = []
        for cell, records in self._records:
            judged = [
                ready.judge(tuned, cell, record, parts).found or {}
                for record, parts in records.take(tuned, cell)
            ]
            values.append([float(each.get(measure, np.nan)) for each in judged])
        return np.array(values)
