"""The axes of a grid: checks those of a map, and lists the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import ceil, prod
from typing import Any, Protocol

from owtsweep.config import key, require
from owtsweep.studies.grid_size import check_blocks

#: Value of each axis of the grid in one cell; an axis without a value is missing.
Cell = Mapping[str, float]
#: Records of a block where records are not long.
RECORDS = 4


class Grid(Protocol):
    """The section `grid`: a list of values, or None, for each axis, and the number of records."""

    @property
    def replicates(self) -> int:
        """Records per cell."""


def key_of_records(drawn: str) -> Any:
    """Declare the key `grid.replicates`; `drawn` is what each record draws with its own seed."""
    return key(
        f"records per cell, each with its own seed of {drawn}",
        ge=1,
        le=10_000,
        advice="use 1 or more",
    )


def check_axes(chosen: Sequence[str], grid: Grid, all_axes: Sequence[str], schemes: int) -> None:
    """Check that the map has two axes with values, that others have one value each, and its size.

    Parameters
    ----------
    chosen
        The key `axes`.
    grid
        The section `grid`.
    all_axes
        The names of all axes.
    schemes
        Number of schemes.

    Raises
    ------
    InputError
        If an axis is unknown, stands there twice or has no value, another has several, or a plan
        would have too many blocks.
    """
    names = ", ".join(all_axes)
    for axis in chosen:
        require(axis in all_axes, f"axes: there is no axis {axis!r}; use two of {names}")
    across, upwards = chosen
    require(across != upwards, f"axes: {across} stands there twice; use two of {names}")
    for axis in all_axes:
        values = getattr(grid, axis)
        if axis in chosen:
            require(
                values is not None,
                f"grid.{axis}: the map is over {axis}, and null is no value; give it some, e.g. "
                f"grid.{axis}=[1,10]",
            )
            continue
        require(
            values is None or len(values) == 1,
            f"grid.{axis}: it has {len(values or [])} values, and the map is over {across} and "
            f"{upwards}; give it one value, or put it among axes=[{across},{upwards}]",
        )
    cells = prod(len(getattr(grid, axis)) for axis in chosen)
    check_blocks(cells * schemes * ceil(grid.replicates / RECORDS))


def list_cells(axes: Sequence[str], grid: Grid) -> list[Cell]:
    """Return all cells, the last axis running fastest; an axis without a value is missing."""
    values = [getattr(grid, axis) or [None] for axis in axes]
    return [
        {axis: value for axis, value in zip(axes, cell, strict=True) if value is not None}
        for cell in product(*values)
    ]
