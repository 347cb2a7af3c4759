"""The blade study as a declaration: from a blade on its hook to schemes' errors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from owtsweep.config import Plain
from owtsweep.evaluation.estimate import Reading
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.studies.base.axes import Cell, Departure, Untold
from owtsweep.studies.base.declaration import Declaration, Quantity, Shown, Stated
from owtsweep.studies.base.schemes import Part
from owtsweep.studies.blade.cases import Case, make_setting, make_world, observe
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.contract import Estimates, Measured, Setting
from owtsweep.studies.blade.doubts import warn_of_doubts
from owtsweep.studies.blade.measures import Judged, compare
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.recorded_case import compare_withheld
from owtsweep.studies.blade.schemes import SCHEMES

#: Most records of a block, and most samples of its records: it keeps their measurements. To write
#: and read the file of a block takes as long as a scheme takes for a record.
MOST_RECORDS, MOST_SAMPLES = 4, 100_000
#: Keys of the truth alone. Outages are left out, because what is judged follows from them, and
#: errors of the start, which schemes are told as they are.
UNTOLD = (
    "grid.sigma", "grid.offset", "grid.lever", "grid.period", "grid.amplitude", "grid.heading",
    "motion.freedoms", "motion.gust_time", "motion.bending", "motion.tugger", "unit.force_sigma",
    "unit.force_bias", "unit.force_walk", "unit.rate_sigma", "unit.rate_bias", "unit.rate_walk",
    "sensors.receiver", "sensors.prism_sigma", "sensors.prism_offset", "sensors.stretch",
)  # fmt: skip
#: Quantities of truth and measurements -> their units.
UNITS = {
    "root": "m",
    "root_velocity": "m/s",
    "rotation": "turns vectors of the body into the frame at rest; its error in the body, rad",
    "unit": "m",
    "unit_velocity": "m/s",
    "rate": "rad/s, in the frame of the body",
    "specific_force": "m/s^2, in the frame of the body",
    "fixes": "m, of each antenna",
    "prisms": "m, of each prism, by the clock of the total stations",
}


def list_content(config: BladeConfig) -> Plain:
    """Return what the rows of every block depend on; files of a lift by their bytes."""
    content, recorded = config.list_content(), config.recorded
    if recorded.imu is not None:
        imu, *gnss = (hash_file(expand_home(name)) for name in (recorded.imu, *recorded.gnss))
        content["recorded"] = content["recorded"] | {"imu": imu, "gnss": gnss}
        content["reference"] = config.grid.sigma[0]
    return content


def _inform(config: BladeConfig, cell: Cell, case: Case) -> dict[str, Part[Setting, Measured]]:
    return {"": Part(make_setting(config, cell, case.start), case.measured)}


def _score(
    config: BladeConfig, cell: Cell, case: Case, parts: object, estimates: Mapping[str, Estimates]
) -> dict[str, float]:
    window = Judged(config.record.settled, find_last_outage(config, cell["outage"]))
    found = compare(case.truth, estimates[""], window)
    if case.withheld is not None:
        off = compare_withheld(estimates[""], case.withheld, case.start.geometry)
        found |= {} if off is None else {"withheld": off}
    return found


def _show(config: BladeConfig, cell: Cell, case: Case) -> Shown:
    """Return a record in the frame with x along the blade from root to tip, z up."""
    truth, measured = case.truth, case.measured
    time = truth.step * np.arange(len(truth.root))
    return Shown(
        time,
        config.record.settled,
        {name: getattr(truth, name) for name in UNITS if hasattr(truth, name)},
        {
            "specific_force": Reading(time, measured.specific_force),
            "rate": Reading(time, measured.rate),
            "fixes": Reading(time[measured.due], measured.fixes[measured.due]),
            "prisms": Reading(measured.prism_times, measured.prisms),
        },
        UNITS,
        {"root": case.start.geometry.root, "unit": case.start.geometry.unit},
    )


def _state(case: Case, estimates: Mapping[str, Estimates]) -> Stated:
    given = estimates[""]
    found = {"root": given.root, "root_velocity": given.root_velocity, "rotation": given.rotation}
    stated = {"root": given.root_covariance, "rotation": given.attitude_covariance}
    return Stated(found, {name: P for name, P in stated.items() if P is not None}, given.latency)


def list_untold(config: BladeConfig) -> Untold:
    """Return what schemes are not told; a world that moves an axis of the map is none.

    A recorded lift is as it is.
    """
    if config.recorded.imu is not None:
        return Untold()
    swing = config.motion.freedoms["u"].period
    departures = {
        "red_fixes": Departure(
            "slow errors of the fixes, .02 m with a time constant of 60 s",
            {"sensors.receiver.red_sigma": 0.02},
        ),
        "reflections": Departure(
            "fixes jump by some .05 m for 5 s, once a minute", {"sensors.receiver.jump_every": 60.0}
        ),
        "late": Departure("time stamps of the fixes come .05 s late", {"grid.offset": 0.05}),
        "lever": Departure("the antenna stands .05 m from where it should", {"grid.lever": 0.05}),
        "longer_swing": Departure(
            "the longitudinal swing takes a fifth longer", {"grid.period": 1.2 * swing}
        ),
    }
    return Untold(UNTOLD, departures).leave_out(config.axes)


DECLARATION = Declaration(
    axes=CONTEST,
    schemes=SCHEMES,
    list_content=list_content,
    most_records=lambda config: max(1, min(MOST_RECORDS, MOST_SAMPLES // config.record.steps)),
    make_truth=make_world,
    measure=observe,
    inform=_inform,
    score=_score,
    estimates={
        "root": Quantity((3,)),
        "root_velocity": Quantity((3,)),
        "rotation": Quantity((3, 3)),
        "root_covariance": Quantity((3, 3), optional=True),
        "attitude_covariance": Quantity((3, 3), optional=True),
        "nis": Quantity((), optional=True),
    },
    count_samples=lambda case: len(case.truth.root),
    show=_show,
    state=_state,
    warn=warn_of_doubts,
    list_untold=list_untold,
)
