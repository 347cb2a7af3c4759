"""A structure in a sea: the motion of motion=plant, and of one sea in place of a spectrum's."""

from __future__ import annotations

from collections.abc import Mapping

from owtsweep import structures, waves
from owtsweep.config import Plain, as_mapping, changed
from owtsweep.errors import InputError, require
from owtsweep.motion.departing import StretchedSource
from owtsweep.motion.plant import Plant
from owtsweep.results.conditions import Value
from owtsweep.structures import Structure
from owtsweep.studies.hub.config import HubConfig
from owtsweep.sweep.study import add_versions
from owtsweep.waves import Sea

#: Value of a condition that leaves what the structure's file says.
LAYERS = "layers"
#: The conditions of the plant, which with motion=spectrum are those of one sea.
ONE_SEA = ("hs", "tp", "blades", "friction_angle")
#: Packages whose code affects the numbers of the plant alone. Their versions are in the content of
#: the plant's blocks, so that blocks of spectra keep their keys.
ROOMS = (structures, waves)


def list_plant(config: HubConfig) -> Plain:
    """Return what the motion of the structure depends on, besides the conditions."""
    motion = config.motion
    names = ("kind", "gamma", "modes", "damping")
    return {
        "motion": {name: getattr(motion, name) for name in names},
        "structure": as_mapping(find_structure(config)),
        "plant_version": add_versions(0, *ROOMS),
    }


def make_plant(config: HubConfig, conditions: Mapping[str, Value]) -> Plant:
    """Return the source of motion under some conditions; raises InputError that names the key."""
    motion, structure = config.motion, find_structure(config)
    angle, damping = conditions["friction_angle"], motion.damping
    if angle != LAYERS and structure.soil is not None:
        structure = changed(structure, soil=structure.soil.with_angle(float(angle)))
    if damping is not None:
        structure = changed(structure, damping=damping)
    try:
        sea = Sea(float(conditions["hs"]), float(conditions["tp"]), motion.gamma)
    except InputError as error:
        raise InputError(f"motion.{error}") from error
    return Plant(structure, sea, int(conditions["blades"]), motion.modes)


def find_structure(config: HubConfig) -> Structure:
    structure = config.structure
    assert structure is not None  # checked before
    return structure


def stretch_sea(config: HubConfig, period: float) -> StretchedSource:
    """Return the motion of the structure in its one sea, slowed until its first mode has a period.

    `period` is in s. Its size is set as that of a spectrum's motion.
    """
    usual: Mapping[str, list[Value]] = {"blades": [0], "friction_angle": [LAYERS]}
    conditions = {name: (getattr(config.motion, name) or usual[name])[0] for name in ONE_SEA}
    plant = make_plant(config, conditions)
    stretch = period * float(plant.vibration.frequency[0])
    return StretchedSource(plant, stretch, config.normalise)


def check_one_sea(config: HubConfig) -> None:
    """Raise `InputError` unless the structure can move in one sea in place of a spectrum."""
    motion = config.motion
    for name in ONE_SEA:
        values = getattr(motion, name) or []
        needed = name in ("hs", "tp")
        require(
            len(values) == 1 or (not needed and not values),
            f"motion.{name}: it has {len(values)} values, and with motion=spectrum the structure "
            "moves in one sea; give one, or add motion=plant",
        )
    require(
        motion.peaks is None,
        "motion.peaks: the structure moves in place of a spectrum; leave one of them out",
    )
    find_structure(config).check()
    stretch_sea(config, 1.0)
