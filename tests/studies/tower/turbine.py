"""A short record of the turbine for tests of the tower study."""

from __future__ import annotations

from functools import partial

import numpy as np

from owtsweep.config import changed
from owtsweep.streams import stream
from owtsweep.studies.registry import compose
from owtsweep.studies.tower.sections import SeaState, TopLoad, Wind
from owtsweep.studies.tower.truth import Motion, make_truth

STEP = 0.01
CUTS = (-30.0, 145.0)
WIND = Wind(
    speed=8.0,
    rotor_area=float(np.pi * 120.0**2),
    rotor_speed=0.0955,
    thrust=TopLoad(mean=1.3e6, sigma=1.3e5),
    moment=TopLoad(mean=-4e7, sigma=5e6),
    side=TopLoad(mean=0.0, sigma=1.2e4),
    side_moment=TopLoad(mean=0.0, sigma=1.2e6),
    line_1p=0.02,
    line_3p=0.1,
    damping=1.2e5,
    side_damping=1.5e4,
)
CONFIG = changed(compose(["study=tower", "structure=iea15", "seed=2019"]), wind=WIND)
STRUCTURE = CONFIG.structure
CALM = SeaState(hs=0.0, tp=11.0)
ROUGH = SeaState(hs=4.5, tp=11.0, yaw=30.0)


def streams(replicate: int = 0):
    """Return the function that gives a record's random streams."""
    return partial(stream, 2019, "tower", [], replicate)


def make(steps: int = 4000, sea: SeaState = CALM, **truth: object) -> dict[str, Motion]:
    """Return the truth of a short record, with keys of the section `truth`."""
    record = changed(CONFIG.record, duration=steps * STEP)
    whole = changed(CONFIG, record=record, waves=sea, truth=changed(CONFIG.truth, **truth))
    return make_truth(whole, 0)
