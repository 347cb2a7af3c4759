"""A short record of the turbine for tests of the tower study."""

from __future__ import annotations

from functools import partial

import numpy as np

from owtsweep.streams import stream
from owtsweep.structures import find_structure
from owtsweep.studies.tower.sections import SeaState, TopLoad, Wind
from owtsweep.studies.tower.truth import Motion, make_truth

STEP = 0.01
CUTS = (-30.0, 145.0)
STRUCTURE = find_structure("iea15")
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
CALM = SeaState(hs=0.0, tp=11.0)
ROUGH = SeaState(hs=4.5, tp=11.0, yaw=30.0)


def streams(replicate: int = 0):
    """Return the function that gives a record's random streams."""
    return partial(stream, 2019, "tower", [], replicate)


def make(steps: int = 4000, sea: SeaState = CALM, **kwargs: object) -> dict[str, Motion]:
    """Return the truth of a short record."""
    return make_truth(STRUCTURE, CUTS, WIND, sea, streams(), steps=steps, step=STEP, **kwargs)
