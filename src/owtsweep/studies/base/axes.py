"""The axes of a grid: checks those of a map, and lists the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import ceil, prod
from typing import Any, Generic, TypeVar

from owtsweep.config import Config, require
from owtsweep.results.conditions import Condition

#: Value of each axis of the grid in one cell; an axis without a value is missing.
Cell = Mapping[str, float]
#: Records of a block where records are not long.
RECORDS = 4
#: Most blocks of a plan: each block is a file, and planning it takes some 0.1 ms.
MOST_BLOCKS = 100_000


C = TypeVar("C", bound=Config)
#: Axis -> its values; None: it has none.
Values = Mapping[str, Sequence[Any] | None]


class Axes(Generic[C]):
    """The axes that a study is swept over.

    conditions: All axes that the grid may have, with the names of its keys.
    section: the section of the configuration that has a key for each axis.
    """

    conditions: tuple[Condition, ...]
    section: str = "grid"

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(condition.name for condition in self.conditions)

    def find_axes(self, config: C) -> Sequence[str]:
        """Return the axes of a map, the horizontal one first: the key `axes`, or all axes."""
        chosen: Sequence[str] = getattr(config, "axes", self.names)
        return chosen

    def find_conditions(self, config: C) -> tuple[Condition, ...]:
        """Return the conditions on the axes of a configuration's map, the horizontal one first."""
        by_name = {condition.name: condition for condition in self.conditions}
        return tuple(by_name[name] for name in self.find_axes(config))

    def find_entering(self, *places: str) -> list[str]:
        """Return the axes that enter at some of "world", "sensors", "knowledge" and "scale"."""
        return [condition.name for condition in self.conditions if condition.enters in places]

    def get_values(self, config: C) -> Values:
        """Return axis -> its values, or None."""
        section = getattr(config, self.section)
        return {axis: getattr(section, axis) for axis in self.names}

    def get_grid(self, config: C) -> Mapping[str, Sequence[Any]]:
        """Return axis -> its values, for the axes of a configuration's map."""
        values = self.get_values(config)
        return {axis: values[axis] or () for axis in self.find_axes(config)}

    def tell(self, cell: Mapping[str, float | None], axes: Sequence[str]) -> list[str]:
        """Return in words where a cell is along some axes; an axis without a value is left out."""
        return [
            f"{condition.word} {condition.show(value)}"
            for condition in self.conditions
            if condition.name in axes and (value := cell.get(condition.name)) is not None
        ]

    def list_cells(self, config: C) -> list[Cell]:
        """Return all cells, the last axis running fastest; an axis without a value is missing."""
        values = {axis: listed for axis, listed in self.get_values(config).items() if listed}
        return [dict(zip(values, cell, strict=True)) for cell in product(*values.values())]


def check_axes(axes: Axes[Any], config: Any) -> None:
    """Check that the map has two axes with values, others have one value each, and its size.

    Raise `InputError` if an axis is unknown, stands there twice or has no value, another has
    several, or a plan would have too many blocks.
    """
    chosen, grid, names = axes.find_axes(config), config.grid, ", ".join(axes.names)
    for axis in chosen:
        require(axis in axes.names, f"axes: there is no axis {axis!r}; use two of {names}")
    across, upwards = chosen
    require(across != upwards, f"axes: {across} stands there twice; use two of {names}")
    for axis in axes.names:
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
    check_blocks(cells * len(config.schemes) * ceil(grid.first / RECORDS))


def check_blocks(blocks: int) -> None:
    """Raise `InputError` if a sweep would have more than `MOST_BLOCKS` blocks.

    Before the sweep is planned. (The hub has bounds of its own.)
    """
    require(
        blocks <= MOST_BLOCKS,
        f"grid: a sweep would have {blocks:.3g} blocks of work, more than {MOST_BLOCKS:.0e}; give "
        "fewer values, schemes or replicates",
    )
