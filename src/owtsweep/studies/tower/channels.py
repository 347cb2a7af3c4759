"""The channels of a sensor set-up: which quantity at which node, and how much noise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.sections import KINDS, Sensors


class Place(NamedTuple):
    """Where a channel is: its kind, its node, and whether it is a GNSS receiver's."""

    kind: Kind
    node: int
    gnss: bool = False


def list_places(sensors: Sensors, cut: PlaneBeam, ground: float) -> list[Place]:
    """Return the channels of each direction: displacements, rotations, accelerations, strains.

    Parameters
    ----------
    sensors
        The section `sensors`.
    cut
        The cut structure.
    ground
        Height of the ground above mean sea level in m.

    Raises
    ------
    InputError
        If a sensor's height has no node.
    """
    places = []
    for name, kind in KINDS.items():
        if name in sensors.every_node:
            places += [Place(kind, node) for node in range(len(cut.heights))]
        places += [
            Place(kind, find_node(cut, height, ground, f"sensors.{name}"))
            for height in getattr(sensors, name)
        ]
    places += [
        Place("x", find_node(cut, height, ground, "sensors.gnss"), gnss=True)
        for height in sensors.gnss
    ]
    return places


def find_node(cut: PlaneBeam, height: float, ground: float, what: str) -> int:
    """Return the node at a height above the ground; raise `InputError` if there is none."""
    from owtsweep.config import require

    above = cut.heights - ground
    near = abs(above - height) <= 1e-6
    require(
        bool(near.any()),
        f"{what}: no node of the mesh is {height:g} m above the ground; take one of "
        f"{', '.join(f'{z:g}' for z in above)}",
    )
    return int(near.argmax())


def count_rotations(places: Sequence[Place]) -> int:
    """Count the inclinometers and displacement sensors of a direction."""
    return sum(place.kind in ("theta", "x") for place in places)
