"""Checks that the values of the tower study's configuration can work together."""

from __future__ import annotations

import logging

import numpy as np

from owtsweep.config import require
from owtsweep.structures.bernoulli import assemble_cut
from owtsweep.studies.base.axes import check_blocks
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.measuring import list_places
from owtsweep.studies.tower.recorded import load_motions
from owtsweep.studies.tower.wind import read_loads

logger = logging.getLogger(__name__)


def check(config: TowerConfig) -> None:
    """Raise `InputError` if two values cannot work together, as seen before a record is made."""
    config.structure.check()
    config.wind.check()
    config.fatigue.check()
    grid, structure = config.grid, config.structure
    require(
        config.waves.hs == 0.0 or (structure.water is not None and structure.mudline < 0.0),
        f"waves.hs: the structure {structure.name} does not stand in water; give sea=calm",
    )
    check_blocks(len(grid.noise) * len(grid.soil_factor) * grid.first * len(config.schemes))
    require(
        min(grid.noise) > 0.0,
        "grid.noise: 0 % makes the covariance R of the sensors singular; give a small number such "
        "as 0.01",
    )
    low, high = config.heights
    require(
        low < high,
        f"cuts: the lower cut at {low - structure.mudline:g} m is not below the upper one at "
        f"{high - structure.mudline:g} m",
    )
    _check_sensors(config)
    require(
        config.recorded.file is None or config.criterion != "damage",
        "criterion: a record holds no damage to compare with; use criterion=displacement",
    )


def check_outside(config: TowerConfig) -> None:
    """Raise `InputError` if a file of recorded loads or of a recorded structure cannot be used."""
    if config.wind.file is not None:
        read_loads(config.wind.file, steps=config.record.steps, step=1.0 / config.record.rate)
    if config.recorded.file is not None:
        _check_recorded(config)


def _check_sensors(config: TowerConfig) -> None:
    places = list_places(config.sensors, config.nodes)
    require(
        len(places) > 0,
        f"sensors: {config.sensors.name} has none, so no load at a cut (F0, M0, F175, M175) can be "
        "estimated; add inclinometers and accelerometers",
    )
    require(
        len(set(places)) == len(places),
        "sensors: two sensors of a kind are at the same height; list each height once",
    )


def warn_of_few_inclinometers(config: TowerConfig) -> None:
    """Log a warning if there are fewer inclinometers per direction than unknown inputs.

    That many are the rule of Simpson et al. (2025), section 5.1, for a stable estimate of inputs.
    Displacement sensors count as well.
    """
    inputs = 5 if config.waves.hs > 0.0 else 4
    places = list_places(config.sensors, config.nodes)
    count = sum(place.kind in ("theta", "x") for place in places)
    if count < inputs:
        logger.warning(
            "sensors: %s has %d inclinometers or displacement sensors per direction for %d unknown "
            "inputs; the rule of Simpson et al. (2025) asks for as many",
            config.sensors.name,
            count,
            inputs,
        )


def _check_recorded(config: TowerConfig) -> None:
    cut = assemble_cut(config.structure, *config.heights)
    motions = load_motions(config, cut, list_places(config.sensors, config.nodes))
    there = {
        "displacement": [motion.displacement[:, ::2] for motion in motions.values()],
        "base_moment": [motions["fa"].inputs[:, 1]] if "fa" in motions else [],
    }
    judged = [name for name, signals in there.items() if any(np.isfinite(s).any() for s in signals)]
    instead = f"; use criterion={' or '.join(judged)}" if judged else ""
    require(
        config.criterion in judged,
        f"criterion: {config.recorded.file} has no column to judge {config.criterion} by{instead}",
    )
