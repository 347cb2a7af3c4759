"""The worlds of the hub study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.studies.hub.plant import PLANT
from owtsweep.studies.hub.spectrum import SPECTRUM
from owtsweep.studies.hub.world import World

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: Value of the key `motion.kind` -> the world that it chooses.
WORLDS: dict[str, World] = {world.name: world for world in (SPECTRUM, PLANT)}


def find_world(config: HubConfig) -> World:
    """Return the world that a configuration chooses."""
    return WORLDS[config.motion.kind]


def require_spectrum(config: HubConfig, what: str) -> None:
    """Raise `InputError` if the motion has no spectrum of Eq. (1), or grows and falls.

    `what` says in words what needs the spectrum.
    """
    world = find_world(config)
    require(
        world.has_spectrum,
        f"motion: {what} needs the spectrum of the motion, which motion={world.name} has not; "
        f"leave out motion={world.name}",
    )
    require(
        config.motion.envelope is None,
        f"motion.envelope: {what} needs motion that neither grows nor falls; use "
        "motion.envelope=null",
    )
