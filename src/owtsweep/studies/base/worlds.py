"""The worlds of a configuration: in each, the truth departs from what schemes are told.

A departure sets keys of the truth and of what sensors measure. Schemes are told of none: what they
know, and all numbers that follow from sensors by rule, are those of the configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, NamedTuple

from owtsweep.config import AnyConfig, with_values
from owtsweep.config.hints import suggest_name
from owtsweep.config.over import NOMINAL, WORLD, find_axis, list_weights, name_worlds
from owtsweep.errors import InputError, require
from owtsweep.studies.base.axes import Axes, Cell


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


def check(
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
