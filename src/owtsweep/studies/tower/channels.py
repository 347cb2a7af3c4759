"""The channels of a sensor set-up: which quantity at which node, and how much noise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.bernoulli import NEAR
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.sections import KINDS, Sensors


class Place(NamedTuple):
    """Where a channel is: its kind, its node, and whether it is a GNSS receiver's."""

    kind: Kind
    node: int
    gnss: bool = False


def list_places(sensors: Sensors, nodes: Array) -> list[Place]:
    """Return the channels of each direction: displacements, rotations, accelerations, strains.

    Parameters
    ----------
    sensors
        The section `sensors`.
    nodes
        Heights of the nodes of the cut structure above the ground in m.

    Raises
    ------
    InputError
        If a sensor's height has no node.
    """
    places = []
    for name, kind in KINDS.items():
        if name in sensors.every_node:
            places += [Place(kind, node) for node in range(len(nodes))]
        places += [
            Place(kind, find_node(nodes, height, f"sensors.{name}"))
            for height in getattr(sensors, name)
        ]
    places += [
        Place("x", find_node(nodes, height, "sensors.gnss"), gnss=True) for height in sensors.gnss
    ]
    return places


def find_node(nodes: Array, height: float, what: str) -> int:
    """Return the node at a height above the ground; raise `InputError` if there is none."""
    near = abs(nodes - height) <= NEAR
    require(
        bool(near.any()),
        f"{what}: no node of the mesh is {height:g} m above the ground; take one of "
        f"{', '.join(f'{z:g}' for z in nodes)}",
    )
    return int(near.argmax())


def count_rotations(places: Sequence[Place]) -> int:
    """Count the inclinometers and displacement sensors of a direction."""
    return sum(place.kind in ("theta", "x") for place in places)
