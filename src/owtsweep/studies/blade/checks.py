"""Checks that the values of the blade study's configuration can work together."""

from __future__ import annotations

import numpy as np

from owtsweep.config import require
from owtsweep.estimation.double_integration import RATE
from owtsweep.motion.lines import HIGHEST
from owtsweep.studies.base.keys import find_freedom
from owtsweep.studies.blade.config import BladeConfig
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.contract import DOF
from owtsweep.studies.blade.truth import hold

#: Angles reach some three standard deviations; Euler angles fail at a pitch of 90 degrees.
REACH, MOST_ANGLE = 3.0, 80.0
#: Fastest accelerometers on the boom, and what passes the filter before decimation, Hz.
FASTEST, PASSED = 1000.0, 8.0
#: Axes over which a recorded lift can be mapped: a prior, and fixes that are withheld.
MAPPED = ("sigma", "outage")
#: An antenna is on the blade.
LONGEST_LEVER = 50.0


def check(config: BladeConfig) -> None:
    """Raise `InputError` if two values cannot work together, as seen before a record is made."""
    config.recorded.check()
    if config.recorded.imu is not None:
        _check_recorded(config)
    _check_motion(config)
    _check_sensors(config)
    _check_boom(config)


def check_outside(config: BladeConfig) -> None:
    """Raise `InputError` if a file of a recorded lift cannot be used."""
    from owtsweep.studies.blade.recorded_case import load_lift

    if config.recorded.imu is not None:
        load_lift(config)


def _check_recorded(config: BladeConfig) -> None:
    grid = config.grid
    require(
        grid.replicates == 1,
        f"grid.replicates: {grid.replicates}, but one lift was recorded; set grid.replicates=1",
    )
    for name in [axis for axis in CONTEST.names if axis not in MAPPED]:
        values = getattr(grid, name)
        require(
            values is None or (len(values) == 1 and values[0] == 0.0),
            f"grid.{name}: a recorded lift has its own; map it over axes=[sigma,outage]",
        )


def _check_motion(config: BladeConfig) -> None:
    motion, grid = config.motion, config.grid
    for name in DOF:
        freedom = find_freedom(motion.freedoms, name, DOF)
        if name in DOF[3:]:
            sizes = [freedom.sigma] if name != "heading" else grid.heading or [freedom.sigma]
            reach = REACH * np.hypot(max(sizes), freedom.gust)
            where = "grid.heading" if name == "heading" and grid.heading else None
            require(
                reach < MOST_ANGLE,
                f"{where or f'motion.freedoms.{name}.sigma'}: {max(sizes):g} deg reaches "
                f"{reach:.3g} deg; give less, so that {MOST_ANGLE:g} deg are not reached",
            )
        natural = freedom.period
        if name in ("heading", "pitch"):
            stiffness = getattr(motion.tugger, name)
            held = hold(freedom, stiffness, motion.tugger.damping)
            natural = held.period
            require(
                held.damping < 1.0,
                f"motion.tugger.damping: {motion.tugger.damping:g} gives {name} a damping ratio of "
                f"{held.damping:.3g}; give less, so that it is below 1",
            )
        period = min([natural, *((grid.period or []) if name == "u" else [])])
        require(
            config.record.rate >= 10.0 * HIGHEST / period,
            f"record.rate: {config.record.rate:g} Hz is too slow for a motion of {period:g} s "
            f"({name}); give {30.0 / period:.4g} Hz or more",
        )
    bending = motion.bending
    require(
        bending.vibration == 0.0 or config.record.rate >= 30.0 / bending.period,
        f"motion.bending.period: record.rate={config.record.rate:g} Hz is too slow for "
        f"{bending.period:g} s; give {30.0 / config.record.rate:.4g} s or more",
    )


def _check_sensors(config: BladeConfig) -> None:
    record, sensors, grid = config.record, config.sensors, config.grid
    ratio = record.rate / sensors.fix_rate
    require(
        ratio >= 1.0,
        f"sensors.fix_rate: GNSS at {sensors.fix_rate:g} Hz is faster than the inertial unit at "
        f"{record.rate:g} Hz; give at most {record.rate:g}",
    )
    require(
        abs(ratio - round(ratio)) < 1e-9,
        f"sensors.fix_rate: {sensors.fix_rate:g} Hz is no part of record.rate={record.rate:g} Hz; "
        f"give {record.rate / round(ratio):.6g}",
    )
    judged = record.duration - record.settling
    longest = max(grid.outage)
    require(
        longest < min(judged, sensors.outage_every),
        f"grid.outage: {longest:g} s leave no fix; give less than sensors.outage_every="
        f"{sensors.outage_every:g} s and than the {judged:g} s that are judged",
    )
    late = max(max(grid.offset), sensors.prism_offset)
    require(
        late < 0.5 * record.duration,
        f"grid.offset: {late:g} s are half of a record of {record.duration:g} s; give less",
    )
    require(
        max(grid.lever) <= LONGEST_LEVER,
        f"grid.lever: {max(grid.lever):g} m is longer than a blade allows; give at most "
        f"{LONGEST_LEVER:g}",
    )
    for chosen in config.by_tuning().values():
        require(
            chosen.filters.lag < record.duration,
            f"filters.lag: the lag is not shorter than the record of {record.duration:g} s; give "
            "less",
        )
    require(
        sensors.prism_rate * record.duration >= 10.0,
        f"sensors.prism_rate: {sensors.prism_rate:g} Hz are fewer than 10 positions in "
        f"{record.duration:g} s; give {10.0 / record.duration:.3g} or more",
    )


def _check_boom(config: BladeConfig) -> None:
    boom = config.boom
    require(
        abs(boom.rate / RATE - round(boom.rate / RATE)) < 1e-9 and RATE <= boom.rate <= FASTEST,
        f"boom.rate: {boom.rate:g} Hz is no whole multiple of {RATE:g} Hz up to {FASTEST:g} Hz; "
        "200 Hz would work",
    )
    for name, mode in boom.modes.items():
        require(
            HIGHEST / mode.period <= PASSED,
            f"boom.modes.{name}.period: {mode.period:g} s vibrates up to "
            f"{HIGHEST / mode.period:.3g} Hz, and {PASSED:g} Hz pass the decimation; give "
            f"{HIGHEST / PASSED:g} s or more",
        )
