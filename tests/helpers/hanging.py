"""Records of a hanging blade for the tests of its filters."""

from functools import cache

import numpy as np

from owtsweep.studies import compose
from owtsweep.studies.blade.cases import make_setting, make_world, observe
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.measures import Judged, compare
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.schemes import SCHEMES

#: One cell without an outage, fibre-optic gyroscopes, everybody told the truth.
CELL = ("study=blade", "axes=[sigma,outage]", "grid.sigma=[0.006]", "grid.outage=[0]", "unit=fog")
#: Next to no noise.
QUIET = (
    "grid.sigma=[1e-7]", "unit.force_sigma=1e-7", "unit.force_bias=0", "unit.force_walk=0",
    "unit.rate_sigma=1e-8", "unit.rate_bias=0", "unit.rate_walk=0", "unit.tilt=1e-6",
    "unit.heading=1e-6", "sensors.start_position=1e-7", "sensors.start_velocity=1e-7",
    "sensors.prism_sigma=1e-9",
)  # fmt: skip


@cache
def make(*words, replicate=0, short=True):
    """Return configuration, truth, measurements and setting of a record; 100 s if short."""
    short_words = ("record.duration=100", "record.settling=20") if short else ()
    config = compose([*CELL, *short_words, *words])
    (cell,) = CONTEST.list_cells(config)
    world = make_world(config, cell, replicate)
    case = observe(config, cell, world)
    return config, world, case.measured, make_setting(config, cell, case.start)


def run(name, setting, measured):
    """Run a scheme on a record."""
    return SCHEMES.resolve(name).prepare(setting).run(measured)


def score(name, *words, replicate=0, short=True):
    """Return measure -> value of a scheme on a record."""
    config, motion, measured, setting = make(*words, replicate=replicate, short=short)
    window = Judged(config.record.settled, find_last_outage(config, config.grid.outage[0]))
    return compare(motion.truth, run(name, setting, measured), window)


def mean_square(found, measure):
    """Return the root of the mean square of a measure over records."""
    return float(np.sqrt(np.mean([each[measure] ** 2 for each in found])))
