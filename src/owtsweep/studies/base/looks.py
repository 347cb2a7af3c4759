"""Plans the next look at a map: more records of the cells that are not decided yet."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pandas as pd

from owtsweep.results.cube import Cube
from owtsweep.results.verdicts import Asked, find_open
from owtsweep.statistics.deciding import LOOKS
from owtsweep.studies.base.axes import Cell
from owtsweep.studies.base.blocks import PlanPart
from owtsweep.sweep.study import Block, Look


def plan_look(
    plan: Callable[[PlanPart], list[Block]],
    cells: Sequence[Cell],
    cube: Cube,
    rows: pd.DataFrame,
    asked: Asked,
) -> Look | None:
    """Return the next look at a map; None if no cell needs one.

    The result depends on the rows alone, so whoever continues a run plans the same.

    plan: Returns the blocks of a part of a configuration.
    cells: All cells of the grid.
    cube, rows: Rows of the looks before, and the cube made of them.
    """
    records, going = find_open(cube, rows, asked)
    if not going:
        return None
    left = {(*cell.conditions.values(),): {*cell.names} for cell in going}

    def find_left(cell: Cell) -> set[str]:
        return left.get(tuple(cell[name] for name in cube.names), set())

    chosen = [cell for cell in cells if find_left(cell)]
    blocks = plan(PlanPart(chosen, records, lambda name, cell: name in find_left(cell)))
    decided = asked.cells - len(going)
    found = (
        f"look {LOOKS.index(records)} ({records // 2} records): {decided} of {asked.cells} cells "
        "decided"
    )
    return Look(blocks, found)
