"""Checks of what moves and of its sensors in the floater study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.config import require
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.schemes import SCHEMES

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig

#: Angles reach some three standard deviations from their mean.
REACH = 3.0
#: Schemes that never take a roll angle for small.
LARGE_ANGLES = ("ERROR_STATE", "PASSIVE_OBSERVER", "LOWPASS")
#: Signal-to-noise ratios in dB beyond which numbers overflow.
LEAST_RATIO, MOST_RATIO = -100.0, 400.0


def check_motion(config: FloaterConfig) -> None:
    """Check what moves.

    Raises
    ------
    InputError
        If a degree of freedom is missing or at rest, an angle too large for the schemes, or the
        file of a recorded motion is missing.
    """
    motion, grid, record = config.motion, config.grid, config.record
    if motion.kind == "recorded":
        require(grid.roll is None, "grid.roll: a recorded motion has its own; use grid.roll=null")
        require(
            motion.file is not None,
            "motion.file: kind=recorded needs a file; give motion.file=basin.csv",
        )
        return
    for name in DOF:
        require(
            name in motion.freedoms,
            f"motion.freedoms: {name} is missing; give all of {', '.join(DOF)}",
        )
        freedom = motion.freedoms[name]
        require(
            freedom.resonance.sigma + freedom.waves > 0.0,
            f"motion.freedoms.{name}: it does not move, so no error is relative to it; give it a "
            "small motion",
        )
        require(
            freedom.resonance.damping < 1.0,
            f"motion.freedoms.{name}.resonance.damping: {freedom.resonance.damping:g} is no "
            "resonance; give a ratio below 1",
        )
        highest = 3.0 / min(freedom.resonance.period, motion.wave_period)
        require(
            record.rate >= 2.0 * highest,
            f"record.rate: {record.rate:g} Hz cannot show motion up to {highest:.4g} Hz ({name}); "
            f"give {np.ceil(2e3 * highest) / 1e3:g} Hz or more",
        )
    _check_angles(config)


def _check_angles(config: FloaterConfig) -> None:
    """Check that pitch stays below 90 degrees, and roll, too, if a scheme takes angles for small.

    At a pitch of 90 degrees roll and yaw are the same (Eq. 2 divides by its cosine). Other schemes
    bear any roll below 180 degrees, where the angle jumps.
    """
    motion, grid = config.motion, config.grid
    names = list_names(config.schemes)
    angled = [name for name in names if name in SCHEMES.listed and name not in LARGE_ANGLES]
    most = 90.0 if angled else 180.0
    who = f", where Euler angles fail ({', '.join(angled)})" if angled else ""
    instead = ", or schemes=[ERROR_STATE]" if angled else ""
    times = REACH if motion.kind == "synthetic" else 1.0
    of_roll, of_pitch = motion.freedoms["phi"], motion.freedoms["theta"]
    for freedom, name, limit in ((of_roll, "phi", most), (of_pitch, "theta", 90.0)):
        own = times * np.hypot(freedom.resonance.sigma, freedom.waves)
        if name == "phi" and grid.roll is not None:
            reach = abs(freedom.mean) + times * max(grid.roll)
            free = max(np.floor((limit - abs(freedom.mean)) / times - 1e-9), 0.0)
            require(
                reach < limit,
                f"grid.roll: {max(grid.roll):g} deg reaches {limit:g} deg{who}; give at most "
                f"{free:g}{instead}",
            )
            continue
        require(
            abs(freedom.mean) + own < limit,
            f"motion.freedoms.{name}: a mean of {freedom.mean:g} deg and {own:.3g} deg about it "
            f"reach {limit:g} deg{who if name == 'phi' else ', where Euler angles fail'}; give "
            f"less motion{instead if name == 'phi' else ''}",
        )


def check_sensors(config: FloaterConfig) -> None:
    """Check the optical system and the inertial unit.

    Raises
    ------
    InputError
        If losses leave no report, a delay none of the record's, reports come faster than samples,
        or a number is too large.
    """
    sensors, record, grid = config.sensors, config.record, config.grid
    require(
        min(grid.snr) >= LEAST_RATIO and max(grid.snr) <= MOST_RATIO,
        f"grid.snr: give {LEAST_RATIO:g} to {MOST_RATIO:g} dB; beyond that numbers overflow",
    )
    require(
        max(grid.delay) <= 0.5 * record.steps,
        f"grid.delay: {max(grid.delay):g} samples are more than half of a record of "
        f"{record.steps}; give at most {record.steps // 2}",
    )
    require(
        sensors.jitter <= 1.0,
        f"sensors.jitter: with {sensors.jitter:g} reports overtake each other; give at most 1",
    )
    _check_losses(config)
    _check_optical_rate(config)


def _check_losses(config: FloaterConfig) -> None:
    """Check that losses leave reports, and that those at given times are told by their keys."""
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
