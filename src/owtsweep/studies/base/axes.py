"""What a study is swept over: the axes of a grid with its cells, and worlds that depart.

In each world the truth departs from what schemes are told. A departure sets keys of the truth and
of what sensors measure. Schemes are told of none: what they know, and all numbers that follow from
sensors by rule, are those of the configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import ceil, prod
from types import MappingProxyType
from typing import Any, Generic, NamedTuple, TypeVar

from owtsweep.config import AnyConfig, Config, with_values
from owtsweep.config.hints import suggest_name
from owtsweep.config.over import NOMINAL, WORLD, find_axis, list_weights, name_worlds
from owtsweep.errors import InputError, require
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


class Departure(NamedTuple):
    """A world that is not what schemes are told.

    sentence: What departs, in words.
    keys: Key of the configuration -> its value in this world.
    """

    sentence: str
    keys: Mapping[str, object]


@dataclass(frozen=True)
class Untold:
    """What of a study's truth and measurements no scheme is told.

    keys: Keys, sections, and axes as `grid.<name>`, that change truth or measurements and nothing
        that schemes are told.
    departures: Name of a world -> how it departs.
    """

    keys: Sequence[str] = ()
    departures: Mapping[str, Departure] = field(default_factory=dict)

    def tell(self) -> dict[str, str]:
        """Return name of a world -> how it departs, in words."""
        return {name: departure.sentence for name, departure in self.departures.items()}

    def leave_out(self, axes: Iterable[str]) -> Untold:
        """Return it without the worlds that move one of some axes: those of the map."""
        mapped = {f"grid.{axis}" for axis in axes}
        kept = {n: each for n, each in self.departures.items() if not mapped & {*each.keys}}
        return replace(self, departures=kept)


class World(NamedTuple):
    """One world of a configuration.

    config: the configuration of truth and measurements.
    moved: Axis of the grid -> its value in truth and measurements, in place of the cell's.
    sentence: What departs, in words.
    """

    config: AnyConfig
    moved: Cell = MappingProxyType({})
    sentence: str = "as schemes are told"

    def place(self, cell: Cell) -> Cell:
        """Return where truth and measurements are, of the cell that schemes are told of."""
        return {**cell, **self.moved}


def make_worlds(axes: Axes[Any], untold: Untold, config: AnyConfig) -> dict[str, World]:
    """Return name -> world of a configuration with the key `over`, the nominal one first.

    Raise `InputError` if a world is not known, a key is on the map or not of the truth alone, or a
    value is wrong.
    """
    axis, values = find_axis(config.over)
    if axis == WORLD:
        departures = {str(name): _find(untold, str(name)) for name in values if name != NOMINAL}
    else:
        key = _find_key(axes, untold, config, axis)
        names = name_worlds(config.over)
        departures = {
            name: Departure(f"{key} is {value}", {key: value})
            for name, value in zip(names, values, strict=True)
        }
    departed = {name: _depart(axes, config, each) for name, each in departures.items()}
    return {NOMINAL: World(config), **departed}


def check_over(
    axes: Axes[Any], untold: Untold, check_truth: Callable[[Any], None], config: AnyConfig
) -> None:
    """Check the key `over`, and that the study can run each of its worlds.

    `check_truth` refuses a configuration of truth and measurements, whatever schemes are told.

    Raise `InputError` as `make_worlds` does, and if weights do not fit, a world is refused, or the
    run has several tunings or no fixed number of records.
    """
    list_weights(config.over)
    require(
        "" in config.by_tuning(),
        f"over: a regret is of one tuning, and this run has {config.tuning_name}; choose one, e.g. "
        f"tuning={next(iter(config.by_tuning()))}",
    )
    require(
        not config.grid.decides,
        "over: a regret is over the same records in each world; give their number, e.g. "
        "grid.replicates=40",
    )
    for name, world in make_worlds(axes, untold, config).items():
        try:
            world.config.check()
            check_truth(world.config)
        except InputError as error:
            raise InputError(f"over: in the world {name}, {error}") from error


def _find(untold: Untold, name: str) -> Departure:
    known = [NOMINAL, *untold.departures]
    require(
        name in known, f"over.{WORLD}: there is no world {name!r} here; {suggest_name(name, known)}"
    )
    return untold.departures[name]


def _find_key(axes: Axes[Any], untold: Untold, config: AnyConfig, name: str) -> str:
    """Return the key that departs; an axis may be named without its section."""
    key = f"{axes.section}.{name}" if name in axes.names else name
    require(
        key not in [f"{axes.section}.{axis}" for axis in axes.find_axes(config)],
        f"over.{name}: this is an axis of the map, so each cell has its own; give another key, or "
        f"over={{{WORLD}: [...]}}",
    )
    sections = [key[:end] for end, sign in enumerate(key) if sign == "."]
    require(
        any(part in untold.keys for part in (key, *sections)),
        f"over.{name}: it does not change the truth alone, which schemes are not told; use one of "
        f"{', '.join(untold.keys) or 'none: here schemes are told all'}",
    )
    return key


def _depart(axes: Axes[Any], config: AnyConfig, departure: Departure) -> World:
    moved = {f"{axes.section}.{axis}": axis for axis in axes.names}
    values = {key: [value] if key in moved else value for key, value in departure.keys.items()}
    try:
        departed = with_values(config, {**values, "over": None})
    except InputError as error:
        raise InputError(f"over: {error}") from error
    found, told = axes.get_values(departed), axes.get_values(config)
    places = [axis for key, axis in moved.items() if key in values]
    changed = {axis: (found[axis] or [])[0] for axis in places if found[axis] != told[axis]}
    return World(departed, changed, departure.sentence)
