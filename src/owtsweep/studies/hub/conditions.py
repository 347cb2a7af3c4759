"""The worlds of the hub study, the conditions that a configuration sweeps over, and its maps."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

from owtsweep.errors import require
from owtsweep.results.conditions import Value
from owtsweep.results.criteria import MILLIMETRE, MILLIMETRE_PER_SECOND, Criterion
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.plant import PLANT
from owtsweep.studies.hub.world import SPECTRUM, World, list_departing

#: Value of the key `motion.kind` -> the world that it chooses.
WORLDS: dict[str, World] = {world.name: world for world in (SPECTRUM, PLANT)}


def find_world(config: HubConfig) -> World:
    return WORLDS[config.motion.kind]


def require_spectrum(config: HubConfig, what: str) -> None:
    """Raise `InputError` unless the motion has one steady spectrum, that of Eq. (1).

    `what` says in words what needs the spectrum.
    """
    world = find_world(config)
    require(
        world.has_spectrum,
        f"motion: {what} needs the spectrum of the motion, which motion={world.name} has not; "
        f"leave out motion={world.name}",
    )
    for key in list_departing(config):
        require(False, f"{key}: {what} needs motion of one steady spectrum; use {key}=null")


#: The order of measures in tables.
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: The measures that decide whether two schemes coincide.
CRITERIA = ("position", "velocity")


#: The measures by which schemes may be judged.
JUDGED = {
    "position": Criterion("position: rms error in the plane", "square", "m", *MILLIMETRE),
    "velocity": Criterion(
        "velocity: rms error in the plane", "square", "m/s", *MILLIMETRE_PER_SECOND
    ),
    "x": Criterion("position northwards: rms error", "square", "m", *MILLIMETRE),
    "y": Criterion("position eastwards: rms error", "square", "m", *MILLIMETRE),
}


def find_amplitude(config: HubConfig, cell: Mapping[str, Value]) -> float | None:
    """Return the amplitude of a cell, m; None: none, motion and noise are run apart.

    It is 1 where no condition is an amplitude: the motion as it is.
    """
    scaled = any(condition.expands for condition in find_world(config).conditions)
    amplitude = cell.get("amplitude", None if scaled else 1.0)
    return None if amplitude is None else float(amplitude)


def list_maps(config: HubConfig) -> dict[str, dict[str, Value]]:
    """List the maps of a run: end of the map's name -> values of the conditions off its axes.

    The first one's name has no end. A condition with a single value is not in the name.
    """
    world = find_world(config)
    grid, further = world.get_grid(config), [c.name for c in world.order_axes(config)[2:]]
    maps: dict[str, dict[str, Value]] = {}
    for values in product(*(grid[name] for name in further)):
        at = dict(zip(further, values, strict=True))
        varied = [f"_{name}_{value}" for name, value in at.items() if len(grid[name]) > 1]
        maps["".join(varied) if maps else ""] = at
    return maps


def criteria(config: HubConfig) -> tuple[str, ...]:
    """Return the measures of best_scheme.csv: position, velocity and the run's criterion."""
    return tuple(dict.fromkeys((*CRITERIA, config.measures.criterion)))
