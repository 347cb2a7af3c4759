"""Set up the choice of inclinometers for a structure, and check a choice on simulated records.

The record that gives the size of every signal (and so the noise of its sensor, and the scale of its
error) is simulated with the loads of the tower study's configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.streams import stream
from owtsweep.structures import Structure
from owtsweep.structures.bernoulli import PlaneBeam, assemble_cut, assemble_whole
from owtsweep.structures.reduction import reduce_free
from owtsweep.structures.stress import strain_matrix, stress_matrix
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, Believed, Channel, Setting
from owtsweep.studies.tower.loads.waves import triangular_load
from owtsweep.studies.tower.models import list_interfaces
from owtsweep.studies.tower.placement import Problem, pose
from owtsweep.studies.tower.truth import Motion, find_damping, make_truth

#: Signals below this share of the largest one of their kind are none: a clamped foot, a free end.
SILENT = 1e-3
#: Welds whose stress has less than this share of the largest standard deviation are not judged: on
#: an S-N curve with m = 5 they have less than 1 % of the largest damage.
IDLE = 0.01 ** (1.0 / 5.0)


@dataclass(frozen=True)
class Case:
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


def divide_tubes(structure: Structure, longest: float) -> Structure:
    """Divide tubes so that no element is longer than `longest` m; sensors can be at the new ends.

    Tapered tubes stay as they are but for rounding, because diameter and wall change linearly.
    """
    tubes = []
    for tube in structure.tubes:
        pieces = int(np.ceil((tube.top - tube.bottom) / longest - 1e-9))
        ends = np.linspace(tube.bottom, tube.top, pieces + 1)
        for number, (low, high) in enumerate(pairwise(map(float, ends)), start=1):
            at = [(z - tube.bottom) / (tube.top - tube.bottom) for z in (low, high)]
            changed = {
                key: [float(np.interp(share, [0.0, 1.0], values)) for share in at]
                for key, values in (("diameter", tube.diameter), ("thickness", tube.thickness))
            }
            name = f"{tube.name}_{number}" if pieces > 1 else tube.name
            changes = {"name": name, "bottom": low, "top": high, **changed}
            tubes.append(tube.model_copy(update=changes))
    return structure.model_copy(update={"tubes": tubes})


def make_case(
    config: TowerConfig,
    structure: Structure,
    *,
    accelerometers: Sequence[float] | None = None,
    inclinometers: Sequence[float] | None = None,
    noise: float = 1.0,
    direction: str = "fa",
    records: int = 1,
) -> Case:
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
    low, high = structure.mudline, structure.hub
    cut = assemble_cut(structure, low, high)
    side = direction == DIRECTIONS[1]
    step = 1.0 / config.record.rate
    motions = tuple(
        make_truth(
            structure, (low, high), config.wind, config.waves,
            partial(stream, config.seed, "tower", [], number), steps=config.record.steps,
            step=step, gravity=config.truth.gravity, subdivision=config.truth.subdivision,
        )[direction]
        for number in range(records)
    )  # fmt: skip
    first = config.record.settled
    shift, push = (part[first:].std(axis=0) for part in
                   (motions[0].displacement, motions[0].acceleration))  # fmt: skip
    sizes = {"a": push[0::2], "theta": shift[1::2]}

    def place(kind: str, heights: Sequence[float] | None, spread: int | None) -> list[Channel]:
        size = sizes[kind]
        heard = np.flatnonzero(size > SILENT * size.max())
        if heights is None:
            ideal = np.linspace(cut.heights[heard[0]], high, spread) if spread else None
            nodes = heard if ideal is None else _nearest(cut, heard, ideal)
        else:
            what = "accelerometers" if kind == "a" else "inclinometers"
            nodes = np.array([cut.find_node(low + height, what) for height in heights])
            require(
                bool(np.all(np.isin(nodes, heard))),
                f"{what}: nothing moves at the clamped foot; leave out the height of 0 m",
            )
        return [Channel(kind, int(n), 0.01 * noise * float(size[n])) for n in nodes]  # type: ignore[arg-type]

    stress = stress_matrix(structure, cut)
    scale = (motions[0].displacement[first:] @ stress.T).std(axis=0)
    judged = scale > IDLE * scale.max()
    whole = assemble_whole(structure, side=side, gravity=config.model.gravity)
    start = whole.find_node(low)
    nodes: Any = np.arange(start, start + len(cut.heights))
    filters = config.filters
    change = np.array([filters.force, filters.moment] * 2 + [filters.wave])
    setting = Setting(
        direction=direction, cut=cut, cut_damping=find_damping(structure, cut),
        reduced=reduce_free(cut, list(list_interfaces(cut)), config.model.modes), whole=whole,
        whole_damping=np.zeros_like(whole.mass),  # the cut's schemes do not look at the whole
        nodes=nodes, wave_shape=triangular_load(structure, cut),
        strain=strain_matrix(structure, cut),
        channels=tuple(place("a", accelerometers, 5)), step=step,
        believed=Believed(change, change, np.full(5, filters.correlation_time)), tuning=filters,
    )  # fmt: skip
    return Case(
        setting=setting,
        candidates=tuple(place("theta", inclinometers, None)),
        stress=stress[judged],
        welds=cut.heights[judged] - low,
        stress_scale=scale[judged],
        moment_scale=float(motions[0].inputs[first:, 1].std()),
        motions=motions,
    )


def simulate(case: Case, chosen: Sequence[int], first: int) -> tuple[float, float]:
    """Run the AKF on the records with some of the candidates; return its real errors.

    `first` is the number of the first sample that is judged. The errors are root mean squares of
    the stress at the worst weld and of M0, each over its scale and averaged over the records.

    Raises
    ------
    Unable
        If the sensors see too little.
    """
    from owtsweep.studies.tower.measuring import Faults, add_errors, take_signals
    from owtsweep.studies.tower.schemes import resolve

    channels = (*case.setting.channels, *(case.candidates[number] for number in chosen))
    setting = replace(case.setting, channels=channels)
    prepared = resolve("AKF_STEADY").prepare(setting)
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


def _nearest(cut: PlaneBeam, nodes: Any, heights: Array) -> Any:
    """Return those of `nodes` that are nearest to heights (m above mean sea level), once each."""
    distance = np.abs(cut.heights[nodes][:, None] - heights)
    return np.unique(nodes[np.argmin(distance, axis=0)])
