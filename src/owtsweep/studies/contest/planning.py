"""Plans the blocks of a contest: some records of one cell and scheme each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from owtsweep.sweep.study import Block


def plan_blocks(
    config: Any,
    cells: Iterable[Any],
    axes: Sequence[str],
    shared: Mapping[str, Any],
    most: int,
) -> list[Block]:
    """Return all blocks of a configuration: one per cell, scheme, and up to `most` records.

    The blocks of a cell and its records are a group: truth and measurements are made once for them.

    Parameters
    ----------
    config
        The configuration.
    cells
        Objects with a value for each axis.
    axes
        The names of all axes.
    shared
        What the rows of every block depend on.
    most
        Most records of a block.
    """
    count = config.grid.replicates
    blocks = []
    for conditions in cells:
        cell = {axis: getattr(conditions, axis) for axis in axes}
        place = ", ".join(f"{axis} {cell[axis]:g}" for axis in config.axes)
        for first in range(0, count, most):
            last = min(first + most, count)
            numbers = f"replicate{f's {first}-{last - 1}' if last - first > 1 else f' {first}'}"
            for scheme in config.schemes:
                content = {**shared, **cell, "replicates": [first, last], "scheme": scheme}
                label = f"{scheme}, {place}, {numbers}"
                blocks.append(Block(f"{place}, {numbers}", label, content, last - first))
    return blocks
