"""Set up the choice of inclinometers on a structure.

Structure, loads, noise and the sensors that are there already are those of the tower study's
configuration. A record gives the size of every signal, and so the noise of its sensor, and the
scale of its error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import require
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import assemble_cut, find_node, stress_matrix
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, Channel, Kind
from owtsweep.studies.tower.measuring import Place, list_places, take_signals
from owtsweep.studies.tower.placement import PlacementCase
from owtsweep.studies.tower.sections import KINDS, Faults
from owtsweep.studies.tower.setting import make_setting, model_substructure
from owtsweep.studies.tower.truth import make_truth

#: Accelerometers where the user names no sensor.
SPREAD = 5
#: Signals below this share of the largest one of their kind are none: a clamped foot, a free end.
SILENT = 1e-3
#: Welds whose stress has less than this share of the largest standard deviation are not judged: on
#: an S-N curve with m = 5 they have less than 1 % of the largest damage.
IDLE = 0.01 ** (1.0 / 5.0)


def divide_tubes(structure: Structure, longest: float, heights: Sequence[float] = ()) -> Structure:
    """Divide tubes, so that sensors can be at the new ends.

    No element is then longer than `longest` m, and one ends at each of `heights` (m above ground)
    that is inside a tube. Tapered tubes stay as they are but for rounding, because diameter and
    wall change linearly.
    """
    tubes = []
    for tube in structure.tubes:
        inside = (structure.mudline + height for height in heights)
        cuts = sorted({tube.bottom, *(z for z in inside if tube.bottom < z < tube.top), tube.top})
        ends = [tube.bottom]
        for low, high in pairwise(cuts):
            pieces = int(np.ceil((high - low) / longest - 1e-9))
            ends += [float(z) for z in np.linspace(low, high, pieces + 1)[1:]]
        for number, (low, high) in enumerate(pairwise(ends), start=1):
            at = [(z - tube.bottom) / (tube.top - tube.bottom) for z in (low, high)]
            shape = {
                key: [float(np.interp(share, [0.0, 1.0], values)) for share in at]
                for key, values in (("diameter", tube.diameter), ("thickness", tube.thickness))
            }
            name = f"{tube.name}_{number}" if len(ends) > 2 else tube.name
            tubes.append(changed(tube, name=name, bottom=low, top=high, **shape))
    return changed(structure, tubes=tubes)


def make_case(
    config: TowerConfig, *, inclinometers: Sequence[float] | None = None, spread: bool = False
) -> PlacementCase:
    """Set up the choice of inclinometers fore-aft on the substructure between the cuts.

    Raise `InputError` if a height has no node, a sensor measures nothing, or the structure does not
    stand.

    config: With one tuning. The noise is the first of `grid.noise`. The sensors of the section
        `sensors` are there whatever is chosen.
    inclinometers: Heights above ground in m to choose from; None: every node without an
        inclinometer.
    spread: Keep only `SPREAD` of the given accelerometers, evenly over the height.
    """
    structure, part, first = config.structure, model_substructure(config), config.record.settled
    motion = make_truth(config, 0)[DIRECTIONS[0]]
    share, nodes, kinds = 0.01 * config.grid.noise[0], config.nodes, KINDS.values()
    everywhere = [Place(kind, node) for kind in kinds for node in range(len(nodes))]
    size = take_signals(motion, part.strain, everywhere, Faults())[first:].std(axis=0)
    sizes = dict(zip(kinds, np.split(size, len(kinds)), strict=True))
    given = _list_given(config, sizes, spread)
    there = [channel.node for channel in given if channel.kind == "theta"]
    offered = _list_offered(nodes, sizes["theta"], there, inclinometers)
    true_stress = stress_matrix(structure, assemble_cut(structure, *config.heights))
    scale = (motion.displacement[first:] @ true_stress.T).std(axis=0)
    judged = scale > IDLE * scale.max()
    return PlacementCase(
        setting=make_setting(config, part, DIRECTIONS[0], 1.0, given, motion),
        candidates=tuple(Channel("theta", n, share * float(sizes["theta"][n])) for n in offered),
        stress=part.stress[judged],
        welds=nodes[judged],
        stress_scale=scale[judged],
        moment_scale=float(motion.inputs[first:, 1].std()),
        ground=structure.mudline,
        wave=config.waves.hs > 0.0,
    )


def _list_given(config: TowerConfig, sizes: Mapping[Kind, Array], spread: bool) -> list[Channel]:
    """Return the sensors that are there already; `sizes` are those of signals at the nodes."""
    nodes = config.nodes
    places = list_places(config.sensors, nodes)
    if spread:
        places = [Place("a", node) for node in _spread(nodes, _list_loud(sizes["a"]))]
    channels = []
    for place in places:
        _require_loud("sensors", nodes, sizes[place.kind], place.node)
        sigma = 0.01 * config.grid.noise[0] * float(sizes[place.kind][place.node])
        if place.gnss:
            sigma = config.sensors.gnss_sigma
        channels.append(Channel(place.kind, place.node, sigma))
    return channels


def _list_offered(
    nodes: Array, size: Array, there: Sequence[int], heights: Sequence[float] | None
) -> list[int]:
    """Return the nodes to choose from: those at `heights`, or all with a signal but those `there`.

    `size` is the standard deviation of the rotation at each node.
    """
    if heights is None:
        return [node for node in _list_loud(size) if node not in there]
    offered = [find_node(nodes, height, "--heights") for height in heights]
    for node in offered:
        _require_loud("--heights", nodes, size, node)
        require(
            node not in there,
            f"--heights: an inclinometer is there already {nodes[node]:g} m above the ground; "
            "leave this height out",
        )
    return offered


def _list_loud(size: Array) -> list[int]:
    return [int(node) for node in np.flatnonzero(size > SILENT * size.max())]


def _require_loud(what: str, nodes: Array, size: Array, node: int) -> None:
    require(
        node in _list_loud(size),
        f"{what}: nothing moves at {nodes[node]:g} m above the ground; leave this height out",
    )


def _spread(heights: Array, nodes: Sequence[int]) -> list[int]:
    own = heights[list(nodes)]
    ideal = np.linspace(own[0], own[-1], SPREAD)
    nearest = np.argmin(np.abs(own[:, None] - ideal), axis=0)
    return sorted({nodes[place] for place in nearest})
