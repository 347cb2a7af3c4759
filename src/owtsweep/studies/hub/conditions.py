"""The conditions of the hub study: natural period and amplitude, or those of the plant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING

from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.studies.hub.plant import LAYERS, SEA_CONDITIONS, get_sea_grid, is_plant

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.results.cube import Cube
    from owtsweep.studies.hub.config import HubConfig

NATURAL_PERIOD = Condition(
    "natural_period", "natural period", "s", in_streams=True, plural="periods"
)
AMPLITUDE = Condition(
    "amplitude", "motion amplitude", "m", scale="log", expands=True, plural="amplitudes"
)
#: The conditions of motion=spectrum.
CONDITIONS = (NATURAL_PERIOD, AMPLITUDE)
#: The order of measures in tables.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: The measures that decide whether two schemes coincide.
CRITERIA = ("position", "velocity")
#: The schemes whose boundary is reported: the first is better at amplitudes below the boundary,
#: the second above.
BOUNDARY = ("HME2", "HME1")


def get_conditions(config: HubConfig) -> tuple[Condition, ...]:
    """Return the conditions, which are the axes of the grid.

    They are natural period and amplitude; with motion=plant, they are sea state (hs and tp), blades
    and friction angle.
    """
    return SEA_CONDITIONS if is_plant(config) else CONDITIONS


def get_grid(config: HubConfig) -> Grid:
    """Return name of a condition -> list of the values that the configuration gives it."""
    if is_plant(config):
        return get_sea_grid(config.motion)
    return {"natural_period": config.grid.natural_period, "amplitude": config.grid.amplitude}


def list_condition_names(config: HubConfig) -> list[str]:
    """Return the names of the conditions that a record's motion has: all but the amplitude."""
    return [c.name for c in get_conditions(config) if not c.expands]


def list_record_conditions(config: HubConfig) -> Iterator[dict[str, Value]]:
    """Yield each combination of the conditions that a record's motion has; sorted.

    Each is a mapping condition -> value. The amplitude is not among the conditions, because a
    motion is only multiplied with it.
    """
    grid = get_grid(config)
    names = list_condition_names(config)
    for values in product(*(sorted(grid[name]) for name in names)):
        yield dict(zip(names, values, strict=True))


def get_map_conditions(config: HubConfig) -> tuple[Condition, ...]:
    """Return the conditions, with the two first that a map has as axes.

    With motion=plant, the axes are the first two conditions with more than one value.
    """
    conditions = get_conditions(config)
    if not is_plant(config):
        return conditions
    grid = get_grid(config)
    return tuple(sorted(conditions, key=lambda condition: len(grid[condition.name]) < 2))


def list_maps(config: HubConfig) -> dict[str, dict[str, Value]]:
    """List the maps of a run: end of the map's name -> values of the conditions off its axes.

    There is one map for each combination of these values; the first one's name has no end. A
    condition with a single value is in the values, but not in the name.
    """
    grid, further = get_grid(config), get_map_conditions(config)[2:]
    maps: dict[str, dict[str, Value]] = {}
    for values in product(*(grid[condition.name] for condition in further)):
        at = dict(zip((condition.name for condition in further), values, strict=True))
        varied = [f"_{name}_{value}" for name, value in at.items() if len(grid[name]) > 1]
        maps["".join(varied) if maps else ""] = at
    return maps


def select(table: pd.DataFrame, at: Mapping[str, Value]) -> pd.DataFrame:
    """Return the rows of a table with given values of conditions, condition -> value."""
    for name, value in at.items():
        table = table[table[name] == value]
    return table


def describe_values(config: HubConfig, at: Mapping[str, Value]) -> str:
    """Return values of conditions in words, e.g. "hs 2 m, blades 0"; "" for no condition.

    A soil that keeps its own layers is not mentioned.
    """
    named = {condition.name: condition for condition in get_conditions(config)}
    return ", ".join(
        f"{named[name].word} {named[name].show(v)}" for name, v in at.items() if v != LAYERS
    )


def make_cube(config: HubConfig, rows: pd.DataFrame, *, baselines: bool = False) -> Cube:
    """Arrange a run's rows as arrays over schemes, conditions, measures and replicates (a cube).

    With `baselines` the cube holds the run's baselines too, after the schemes.
    """
    from owtsweep.results.cube import Cube
    from owtsweep.studies.hub.names import list_baselines
    from owtsweep.studies.hub.resolving import scheme_names

    names = scheme_names(config) + (list_baselines(config) if baselines else [])
    conditions = get_conditions(config)
    return Cube.of_rows(rows, names, conditions, get_grid(config), measures=MEASURES)


def criteria(config: HubConfig) -> tuple[str, ...]:
    """Return the measures by whose MSE best_scheme.csv ranks the schemes.

    These measures are "position", "velocity" and the configured `measures.criterion`. A measure is
    listed only once.
    """
    return tuple(dict.fromkeys(("position", "velocity", config.measures.criterion)))
