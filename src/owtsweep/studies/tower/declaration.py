"""The tower study as a declaration: from loads on a structure to schemes' errors.

A record has a part for each direction, fore-aft and side-side.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Plain
from owtsweep.evaluation.estimate import Reading
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.studies.base.axes import Cell, Departure, Untold
from owtsweep.studies.base.declaration import Declaration, Quantity, Shown, Stated
from owtsweep.studies.base.schemes import Part
from owtsweep.studies.tower.case import Case, list_channels, make_case, measure, name_channel
from owtsweep.studies.tower.checks import warn_of_few_inclinometers
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import CONTEST, describe_sight
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS, Channel, Estimates, Setting
from owtsweep.studies.tower.measures import compare, find_quietest
from owtsweep.studies.tower.recorded import measure as compare_with_record
from owtsweep.studies.tower.recorded import read_record
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.setting import make_setting
from owtsweep.studies.tower.sight import require_sight
from owtsweep.studies.tower.wind import read_file

logger = logging.getLogger(__name__)

#: What schemes are not told: worlds in which sensors are worse than assumed. Loads and structure
#: are left out, and what an inclinometer or accelerometer feels besides: schemes are told sizes
#: that follow from the motion and the signals themselves.
UNTOLD = Untold(
    ("faults.bias", "faults.drift", "faults.loss", "faults.loss_length"),
    {
        "biased": Departure(
            "each channel has an offset of a tenth of its standard deviation", {"faults.bias": 0.1}
        ),
        "drifting": Departure(
            "each channel drifts by a tenth of its standard deviation in 100 s",
            {"faults.drift": 0.1},
        ),
        "outages": Departure(
            "some 1 % of the samples repeat the last one, in outages of 100",
            {"faults.loss": 1e-4, "faults.loss_length": 100},
        ),
    },
)
UNITS = {
    "displacement": "m and rad, translation and rotation of each node of the cut structure",
    "inputs": f"N and N m, {', '.join(INPUTS)} on the cut structure",
    "wave": "N/m at sea level",
    "x": "m",
    "theta": "rad",
    "a": "m/s^2",
    "strain": "of the outer fibre, no unit",
    "gnss": "m",
}


class Record(NamedTuple):
    """One record with its channels and measurements, shape (steps, channels), by direction."""

    case: Case
    channels: dict[str, list[Channel]]
    measured: dict[str, Array]


def list_content(config: TowerConfig) -> Plain:
    """Return what the rows of every block depend on, without names; files by their bytes."""
    content = config.list_content() | {"cuts": list(config.heights)}
    if config.recorded.file is not None:
        content["recorded"]["file"] = hash_file(expand_home(config.recorded.file))
    if config.wind.file is not None:
        content["loads"] = hash_file(expand_home(config.wind.file))
    return content


def _measure(config: TowerConfig, cell: Cell, case: Case) -> Record:
    channels = {d: list_channels(config, case, d, cell["noise"]) for d in case.motion}
    measured = {d: measure(config, case, d, channels[d]) for d in case.motion}
    return Record(case, channels, measured)


def _inform(config: TowerConfig, cell: Cell, record: Record) -> dict[str, Part[Setting, Array]]:
    """Return both directions; a scheme that ignores the soil gets the right one."""
    case, factor = record.case, cell.get("soil_factor", 1.0)
    settings = {
        d: make_setting(config, case.part, d, factor, channels, case.motion[d])
        for d, channels in record.channels.items()
    }
    return {d: Part(setting, record.measured[d]) for d, setting in settings.items()}


def _score(
    config: TowerConfig, cell: Cell, record: Record, parts: object,
    estimates: Mapping[str, Estimates],
) -> dict[str, float]:  # fmt: skip
    case, part = record.case, record.case.part
    if config.recorded.file is not None:
        found = compare_with_record(case.motion, estimates, part.cut, config.record.settled)
    else:
        found = compare(config, part, case.motion, case.fatigue, estimates)
    return found | find_quietest(record.channels.get(DIRECTIONS[0], []))


def _show(config: TowerConfig, cell: Cell, record: Record) -> Shown:
    """Return a record; names of quantities and signals end with the direction, "_fa" or "_ss"."""
    case = record.case
    time = np.arange(config.record.steps) / config.record.rate
    truth = {
        f"{name}_{d}": getattr(motion, name)
        for d, motion in case.motion.items()
        for name in ("displacement", "inputs", "wave")
    }
    signals = {
        f"{name_channel(case, place)}_{d}": Reading(time, record.measured[d][:, i])
        for d in case.motion
        for i, place in enumerate(case.places)
    }
    units = {name: UNITS[name.partition("_")[0]] for name in [*truth, *signals]}
    return Shown(time, config.record.settled, truth, signals, units)


def _state(record: Record, estimates: Mapping[str, Estimates]) -> Stated:
    """Return quantities of both directions; no scheme of this study states a covariance."""
    found: dict[str, Array] = {}
    for d, given in estimates.items():
        found[f"displacement_{d}"], found[f"inputs_{d}"] = given.displacement, given.inputs
        if given.wave is not None:
            found[f"wave_{d}"] = given.wave
    return Stated(found, {}, max(given.latency for given in estimates.values()))


def _warn(config: TowerConfig) -> None:
    for line in describe_sight(config):
        logger.info("%s", line)
    if config.recorded.file is not None:
        read_record(config.recorded).found.log_notes()
    if config.wind.file is not None:
        read_file(config.wind.file).log_notes()
    warn_of_few_inclinometers(config)


DECLARATION = Declaration(
    axes=CONTEST,
    schemes=SCHEMES,
    list_content=list_content,
    most_records=lambda config: 1,
    shared=("world",),
    make_truth=lambda config, cell, replicate: make_case(config, replicate),
    measure=_measure,
    inform=_inform,
    score=_score,
    estimates={
        "displacement": Quantity((-1,)),
        "inputs": Quantity((len(INPUTS),)),
        "wave": Quantity((), optional=True),
    },
    count_samples=lambda record: len(next(iter(record.measured.values()))),
    show=_show,
    state=_state,
    warn=_warn,
    require=require_sight,
    list_untold=lambda config: UNTOLD,
)
