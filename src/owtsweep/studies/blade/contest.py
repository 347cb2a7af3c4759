"""What is the blade study's own in the contest of its schemes: axes, criteria, a run in words."""

from __future__ import annotations

from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import WAIT, Contest, Costs, tell_single
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.measures import CRITERIA, OTHERS
from owtsweep.studies.blade.recorded import REFERENCE

#: The axes that the grid may have, of which a map shows two.
CONDITIONS = (
    Condition("sigma", "standard deviation of a GNSS fix", "m", scale="log", enters="sensors"),
    Condition("outage", "length of an outage of GNSS", "s", enters="sensors"),
    Condition("offset", "by what GNSS time stamps come late", "s", enters="sensors"),
    Condition("period", "natural period of the swing", "s"),
    Condition("amplitude", "standard deviation of the swing", "m", scale="log"),
    Condition("lever", "error of the antenna's place", "m", enters="sensors"),
    Condition("heading", "standard deviation of the heading", "deg", scale="log"),
)
#: Values of axes of which nothing needs to be said.
USUAL = {"outage": 0.0, "offset": 0.0, "lever": 0.0}


def describe_truth(config: BladeConfig) -> str:
    """Return the motion and the length of the records in words."""
    record, swing = config.record, config.motion.freedoms["u"]
    if config.recorded.imu is not None:
        return (
            f"recorded lift, {record.duration:g} s at {record.rate:g} Hz; its reference is "
            f"{REFERENCE} with all fixes"
        )
    parts = []
    if "period" not in config.axes:
        parts.append(f"{(config.grid.period or [swing.period])[0]:g} s")
    if "amplitude" not in config.axes:
        parts.append(f"{(config.grid.amplitude or [swing.sigma])[0]:g} m rms")
    text = f", swing of {' and '.join(parts)}" if parts else ""
    return f"rigid blade on a hook{text}; {record.duration:g} s at {record.rate:g} Hz"


def describe_sensors(config: BladeConfig) -> str:
    """Return in words what sensors do, the axes that have one value among it."""
    words = [f"inertial unit of grade {config.grade}", f"GNSS at {config.sensors.fix_rate:g} Hz"]
    return ", ".join([*words, *tell_single(CONDITIONS, config, USUAL)])


#: Measured on one core of a server of 2026, 300 s at 50 Hz.
COSTS = Costs(
    record=3.5e-6,
    schemes={
        "HOLD": 1.3e-6, "GNSS_WAHBA": 1.6e-6, "COMPLEMENTARY": 1.6e-6, "UKF": 13e-6,
        "MEKF": 3.3e-6, "INVARIANT_EKF": 7.1e-6, "MEKF_HEADING": 3.4e-6, "MEKF_OFFSET": 3.4e-6,
        "MEKF_LEVER": 3.5e-6, "PENDULUM": 7.1e-6, "FIXED_LAG": 20e-6, "SMOOTHER": 12e-6,
        "DOUBLE_INTEGRATION": 2.4e-6, "TOTAL_STATIONS": 3.4e-6,
    },
    memory=570e6,
)  # fmt: skip

CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    measures=(*CRITERIA, WAIT, *OTHERS),
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors scale noise, and move or leave out reports, but draw no other numbers
    pairing=("seed", "record", "motion", "boom", "unit"),
    costs=COSTS,
)
