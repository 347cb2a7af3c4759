"""Makes the records of the tower study: truth once per replicate, measurements once per noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.structures.bernoulli import assemble_cut, strain_matrix, stress_matrix
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import Channel
from owtsweep.studies.tower.measures import Fatigue, find_fatigue
from owtsweep.studies.tower.measuring import Place, add_errors, list_places, take_signals
from owtsweep.studies.tower.recorded import load_motions
from owtsweep.studies.tower.setting import Substructure, model_substructure
from owtsweep.studies.tower.truth import Motion, make_truth


@dataclass(frozen=True)
class Case:
    """One record: motion and loads, signals without noise, and the schemes' substructure.

    replicate, motion: Number of the record, and direction -> truth.
    fatigue: Direction -> what the true cycles do; {} if the motion is recorded: it has stresses
        nowhere.
    part: the substructure as schemes model it.
    places: the channels of each direction.
    signals: Direction -> signals of the channels without noise, shape (steps, channels).
    """

    replicate: int
    motion: dict[str, Motion]
    fatigue: dict[str, Fatigue]
    part: Substructure
    places: list[Place]
    signals: dict[str, Array]


def make_case(config: TowerConfig, replicate: int) -> Case:
    """Simulate the record with a number, or read the one that `recorded.file` names.

    Raise `InputError` if the structure does not stand, or loads or sensors cannot be used.
    """
    structure, recorded = config.structure, config.recorded.file is not None
    cut = assemble_cut(structure, *config.heights)
    strain, stress = strain_matrix(structure, cut), stress_matrix(structure, cut)
    places = list_places(config.sensors, config.nodes)
    motion = load_motions(config, cut, places) if recorded else make_truth(config, replicate)
    return Case(
        replicate=replicate,
        motion=motion,
        fatigue={
            direction: find_fatigue(config, cut.heights, moved, stress)
            for direction, moved in ({} if recorded else motion).items()
        },
        part=model_substructure(config),
        places=places,
        signals={
            direction: take_signals(moved, strain, places, config.faults)
            for direction, moved in motion.items()
        },
    )


def list_channels(config: TowerConfig, case: Case, direction: str, noise: float) -> list[Channel]:
    """Return the channels of a direction with the noise that schemes assume.

    `noise` is in % of each channel's standard deviation; a GNSS receiver has its own. Raise
    `InputError` if a channel measures a constant, so that its noise would be zero.
    """
    size = case.signals[direction].std(axis=0)
    channels = []
    for place, own in zip(case.places, size, strict=True):
        sigma = config.sensors.gnss_sigma if place.gnss else 0.01 * noise * float(own)
        require(
            sigma > 0.0,
            f"sensors: what {name_channel(case, place)} measures does not change, so its noise "
            "would be zero and R singular; leave it out",
        )
        channels.append(Channel(place.kind, place.node, sigma))
    return channels


def measure(config: TowerConfig, case: Case, direction: str, channels: Sequence[Channel]) -> Array:
    """Return the measurements of a direction, shape (steps, channels).

    Noise is drawn per channel, and scaled: a larger noise is the same noise enlarged.
    """
    return add_errors(
        case.signals[direction],
        np.array([channel.sigma for channel in channels]),
        config.faults,
        config.draws(case.replicate),
        [f"{name_channel(case, place)}_{direction}" for place in case.places],
        1.0 / config.record.rate,
    )


def name_channel(case: Case, place: Place) -> str:
    """Return the name of a channel: kind and height above the ground, e.g. "theta_58"."""
    height = case.part.cut.heights[place.node] - case.part.structure.mudline
    return f"{'gnss' if place.gnss else place.kind}_{height:g}"
