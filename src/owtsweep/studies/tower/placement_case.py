"""Set up the choice of inclinometers for a structure, and check a choice on simulated records.

The record that gives the size of every signal (and so the noise of its sensor, and the scale of its
error) is simulated with the loads of the tower study's configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import require
from owtsweep.streams import stream
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import PlaneBeam, assemble_cut
from owtsweep.structures.stress import stress_matrix
from owtsweep.studies.tower.believed import make_believed
from owtsweep.studies.tower.channels import find_node
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import Channel, Setting
from owtsweep.studies.tower.placement import Problem, pose
from owtsweep.studies.tower.setting import make_setting, model_substructure
from owtsweep.studies.tower.truth import Motion, make_truth

#: Accelerometers where none are named.
SPREAD = 5
#: Signals below this share of the largest one of their kind are none: a clamped foot, a free end.
SILENT = 1e-3
#: Welds whose stress has less than this share of the largest standard deviation are not judged: on
#: an S-N curve with m = 5 they have less than 1 % of the largest damage.
IDLE = 0.01 ** (1.0 / 5.0)


@dataclass(frozen=True)
class PlacementCase:
    """A structure with its sensors to choose from, in one direction.

    Attributes
    ----------
    setting
        The structure and its tuning; the channels are the accelerometers, which are given.
    candidates
        Inclinometers to choose from, upwards.
    stress
        Stress (Pa) at the judged welds for unit degrees of freedom of the cut, shape (welds, dof).
    welds
        Heights of the judged welds above ground in m, shape (welds,).
    stress_scale
        Standard deviation of the true stress at these welds in Pa, shape (welds,).
    moment_scale
        Standard deviation of the true M0 in N m.
    motions
        The true motion of each record.
    """

    setting: Setting
    candidates: tuple[Channel, ...]
    stress: Array
    welds: Array
    stress_scale: Array
    moment_scale: float
    motions: tuple[Motion, ...]

    @property
    def problem(self) -> Problem:
        """The choice as a problem; its errors are shares of the true standard deviations."""
        return pose(
            self.setting,
            self.candidates,
            self.stress,
            stress_scale=self.stress_scale,
            moment_scale=self.moment_scale,
        )


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
    config: TowerConfig,
    structure: Structure,
    *,
    accelerometers: Sequence[float] | None = None,
    inclinometers: Sequence[float] | None = None,
    noise: float = 1.0,
    direction: str = "fa",
    records: int = 1,
) -> PlacementCase:
    """Set up the choice of inclinometers on the substructure from the ground to the top.

    Parameters
    ----------
    config
        The tower study's configuration: loads, lengths of records, tuning, number of modes. Its
        structure and its sensors are not used.
    structure
        The structure, checked.
    accelerometers
        Heights above ground in m of the accelerometers, which are given; None: 5 over the height.
    inclinometers
        Heights above ground in m to choose from; None: every node.
    noise
        Standard deviation of each sensor's noise in percent of its signal's.
    direction
        "fa" or "ss".
    records
        Number of records to simulate. The first one gives the scales.

    Raises
    ------
    InputError
        If a height has no node, or the structure does not stand.
    """
    require(noise > 0.0, f"noise: {noise:g} % leaves the covariance R singular; give more than 0")
    config = changed(config, structure=structure, cuts=None)
    part = model_substructure(config)
    low, step, first = structure.mudline, 1.0 / config.record.rate, config.record.settled
    motions = tuple(
        make_truth(
            structure, config.heights, config.wind, config.waves,
            partial(stream, config.seed, "tower", (), number), steps=config.record.steps,
            step=step, gravity=config.truth.gravity, subdivision=config.truth.subdivision,
        )[direction]
        for number in range(records)
    )  # fmt: skip
    turning = motions[0].displacement[first:, 1::2].std(axis=0)
    pushing = motions[0].acceleration[first:, 0::2].std(axis=0)
    given = _place("accelerometers", part.cut, low, pushing, accelerometers)
    if accelerometers is None:
        given = _spread(part.cut, given)
    offered = _place("inclinometers", part.cut, low, turning, inclinometers)
    share = 0.01 * noise
    channels = [Channel("a", node, share * float(pushing[node])) for node in given]
    believed = make_believed(config.filters, step, motions[0])
    true_stress = stress_matrix(structure, assemble_cut(structure, *config.heights))
    scale = (motions[0].displacement[first:] @ true_stress.T).std(axis=0)
    judged = scale > IDLE * scale.max()
    return PlacementCase(
        setting=make_setting(config, part, direction, 1.0, channels, believed),
        candidates=tuple(Channel("theta", node, share * float(turning[node])) for node in offered),
        stress=part.stress[judged],
        welds=part.cut.heights[judged] - low,
        stress_scale=scale[judged],
        moment_scale=float(motions[0].inputs[first:, 1].std()),
        motions=motions,
    )


def simulate(case: PlacementCase, chosen: Sequence[int], first: int) -> tuple[float, float]:
    """Run the AKF on the records with some of the candidates; return its real errors.

    `first` is the number of the first sample that is judged. The errors are root mean squares of
    the stress at the worst weld and of M0, each over its scale and averaged over the records.

    Raises
    ------
    Unable
        If the sensors see too little.
    """
    from owtsweep.studies.tower.measuring import Faults, add_errors, take_signals
    from owtsweep.studies.tower.schemes import SCHEMES

    channels = (*case.setting.channels, *(case.candidates[number] for number in chosen))
    setting = replace(case.setting, channels=channels)
    prepared = SCHEMES.resolve("AKF_STEADY").prepare(setting)
    sigma = np.array([channel.sigma for channel in channels])
    places = [(channel.kind, channel.node) for channel in channels]
    names = [f"{kind}_{node}" for kind, node in places]
    faults = Faults()
    errors = []
    for number, motion in enumerate(case.motions):
        signals = take_signals(motion, setting.strain, places, faults)
        draw = partial(stream, 0, "tower", [], number)
        guess = prepared.run(add_errors(signals, sigma, faults, draw, names, setting.step))
        wrong = (guess.displacement - motion.displacement)[first:] @ case.stress.T
        stress = np.sqrt(np.mean(wrong**2, axis=0)) / case.stress_scale
        moment = np.sqrt(np.mean((guess.inputs - motion.inputs)[first:, 1] ** 2))
        errors.append((stress.max(), moment / case.moment_scale))
    stress_error, moment_error = np.mean(errors, axis=0)
    return float(stress_error), float(moment_error)


def _place(
    what: str, cut: PlaneBeam, ground: float, size: Array, heights: Sequence[float] | None
) -> list[int]:
    """Return the nodes at heights above the ground; None stands for all nodes with a signal.

    `size` is the standard deviation of the signal at each node; `what` names the sensors.
    """
    loud = [int(node) for node in np.flatnonzero(size > SILENT * size.max())]
    if heights is None:
        return loud
    nodes = [find_node(cut.heights - ground, height, what) for height in heights]
    for node, height in zip(nodes, heights, strict=True):
        require(
            node in loud,
            f"{what}: nothing moves at {height:g} m above the ground, where the structure is "
            "clamped; leave this height out",
        )
    return nodes


def _spread(cut: PlaneBeam, nodes: Sequence[int]) -> list[int]:
    """Return up to `SPREAD` of the nodes, evenly over the height."""
    heights = cut.heights[list(nodes)]
    ideal = np.linspace(heights[0], heights[-1], SPREAD)
    nearest = np.argmin(np.abs(heights[:, None] - ideal), axis=0)
    return sorted({nodes[place] for place in nearest})
