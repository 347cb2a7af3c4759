"""Checks that the values of the floater study's configuration can work together."""

from __future__ import annotations

import numpy as np

from owtsweep.config import require
from owtsweep.motion.lines import HIGHEST, Span
from owtsweep.studies.base.keys import find_freedom
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.motion_recorded import read_motion
from owtsweep.studies.floater.schemes import LARGE_ANGLES, SCHEMES

#: Signal-to-noise ratios in dB beyond which numbers overflow.
LEAST_RATIO, MOST_RATIO = -100.0, 400.0
#: Kind of a simulated motion -> how many times its standard deviation an angle reaches about its
#: mean, or its deflection.
REACH = {"synthetic": 3.0, "decay": 1.0}


def check(config: FloaterConfig) -> None:
    """Raise `InputError` if two values cannot work together, as seen before a record is made."""
    if config.motion.kind == "recorded":
        _check_recorded(config)
    else:
        _check_freedoms(config)
        _check_angles(config)
    _check_sensors(config)
    _check_times(config)


def check_outside(config: FloaterConfig) -> None:
    """Raise `InputError` if the file of a recorded motion cannot be used."""
    if config.motion.kind == "recorded":
        read_motion(config.motion, None, Span(config.record.steps, 1.0 / config.record.rate))


def _check_recorded(config: FloaterConfig) -> None:
    require(
        config.grid.roll is None,
        "grid.roll: a recorded motion has its own; use grid.roll=null",
    )
    require(
        config.motion.file is not None,
        "motion.file: kind=recorded needs a file; give motion.file=basin.csv",
    )


def _check_freedoms(config: FloaterConfig) -> None:
    """Check that every degree of freedom moves, in a resonance that the samples show."""
    motion, record = config.motion, config.record
    for name in DOF:
        freedom = find_freedom(motion.freedoms, name, DOF)
        require(
            freedom.resonance.sigma + freedom.waves > 0.0,
            f"motion.freedoms.{name}: it does not move, so no error is relative to it; give it a "
            "small motion",
        )
        highest = HIGHEST / min(freedom.resonance.period, motion.wave_period)
        require(
            record.rate >= 2.0 * highest,
            f"record.rate: {record.rate:g} Hz cannot show motion up to {highest:.4g} Hz ({name}); "
            f"give {np.ceil(2e3 * highest) / 1e3:g} Hz or more",
        )


def _check_angles(config: FloaterConfig) -> None:
    """Check that pitch stays below 90 degrees, and roll, too, if a scheme takes angles for small.

    At a pitch of 90 degrees roll and yaw are the same (Eq. 2 divides by its cosine). Other schemes
    bear any roll below 180 degrees, where the angle jumps.
    """
    motion, grid, times = config.motion, config.grid, REACH[config.motion.kind]
    names = list_names(config.schemes)
    angled = [name for name in names if name in SCHEMES.listed and name not in LARGE_ANGLES]
    most = 90.0 if angled else 180.0
    who = f", where Euler angles fail ({', '.join(angled)})" if angled else ""
    instead = ", or schemes=[ERROR_STATE]" if angled else ""
    checked = {"phi": (most, who, instead), "theta": (90.0, ", where Euler angles fail", "")}
    if grid.roll is not None:
        checked.pop("phi")
        mean = abs(motion.freedoms["phi"].mean)
        free = max(np.floor((most - mean) / times - 1e-9), 0.0)
        require(
            mean + times * max(grid.roll) < most,
            f"grid.roll: {max(grid.roll):g} deg reaches {most:g} deg{who}; give at most "
            f"{free:g}{instead}",
        )
    for name, (limit, where, otherwise) in checked.items():
        freedom = motion.freedoms[name]
        own = times * np.hypot(freedom.resonance.sigma, freedom.waves)
        require(
            abs(freedom.mean) + own < limit,
            f"motion.freedoms.{name}: a mean of {freedom.mean:g} deg and {own:.3g} deg about it "
            f"reach {limit:g} deg{where}; give less motion{otherwise}",
        )


def _check_times(config: FloaterConfig) -> None:
    """Check that times that schemes assume lie within a record."""
    for tuning in config.by_tuning().values():
        for key in ("lag", "delay_declared"):
            value = getattr(tuning.filters, key)
            require(
                value < config.record.duration,
                f"filters.{key}: {value:g} s are not shorter than the record of "
                f"{config.record.duration:g} s; give less",
            )


def _check_sensors(config: FloaterConfig) -> None:
    record, grid = config.record, config.grid
    require(
        min(grid.snr) >= LEAST_RATIO and max(grid.snr) <= MOST_RATIO,
        f"grid.snr: give {LEAST_RATIO:g} to {MOST_RATIO:g} dB; beyond that numbers overflow",
    )
    require(
        max(grid.delay) <= 0.5 * record.steps,
        f"grid.delay: {max(grid.delay):g} samples are more than half of the record's "
        f"{record.steps}; give at most {record.steps // 2}",
    )
    _check_losses(config)
    _check_optical_rate(config)


def _check_losses(config: FloaterConfig) -> None:
    """Check that losses leave reports, and that those at given times fit."""
    sensors, record, grid = config.sensors, config.record, config.grid
    require(
        max(grid.loss) < 1.0,
        f"grid.loss: {max(grid.loss):g} leaves no report; give shares below 1",
    )
    require(
        sensors.loss_length < record.duration,
        f"sensors.loss_length: {sensors.loss_length:g} s are not shorter than the record of "
        f"{record.duration:g} s; give less",
    )
    if sensors.loss_every is None:
        return
    length = max(round(sensors.loss_length * record.rate), 1)
    require(
        round(sensors.loss_every * record.rate) > length,
        f"sensors.loss_every: a loss of {sensors.loss_length:g} s every {sensors.loss_every:g} s "
        f"leaves no report; give {(length + 1) / record.rate:g} s or more",
    )
    require(
        sensors.loss_every < record.duration,
        f"sensors.loss_every: no loss comes every {sensors.loss_every:g} s in a record of "
        f"{record.duration:g} s; give less, or sensors.loss_every=null",
    )
    require(
        max(grid.loss) == 0.0,
        f"grid.loss: with losses every {sensors.loss_every:g} s there is no share of random ones; "
        "use grid.loss=[0], or sensors.loss_every=null",
    )


def _check_optical_rate(config: FloaterConfig) -> None:
    """Check that reports come at most at every sample, and often enough for what moves."""
    sensors, record, motion = config.sensors, config.record, config.motion
    if sensors.optical_rate is None:
        return
    require(
        sensors.optical_rate <= record.rate,
        f"sensors.optical_rate: {sensors.optical_rate:g} Hz is above record.rate, "
        f"{record.rate:g} Hz; give at most that",
    )
    if motion.kind == "recorded":
        return
    periods = [freedom.resonance.period for freedom in motion.freedoms.values()]
    if motion.kind == "synthetic":
        periods.append(motion.wave_period)
    fastest = 1.0 / min(periods)
    require(
        sensors.optical_rate > 2.0 * fastest,
        f"sensors.optical_rate: {sensors.optical_rate:g} Hz does not show motion of {fastest:.3g} "
        f"Hz (waves, or the fastest resonance); give more than {2.0 * fastest:.3g} Hz",
    )
