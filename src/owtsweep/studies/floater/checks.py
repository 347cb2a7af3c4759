"""Checks that the values of the floater study's configuration can work together."""

from __future__ import annotations

from owtsweep.config import require
from owtsweep.studies.base.axes import check_axes
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.worlds import WORLDS

#: Most samples of a record: of more, motion and estimates do not fit into memory.
MOST_SAMPLES = 1_000_000
#: Signal-to-noise ratios in dB beyond which numbers overflow.
LEAST_RATIO, MOST_RATIO = -100.0, 400.0


def check(config: FloaterConfig) -> None:
    """Raise `InputError` if two values cannot work together, as seen before a record is made."""
    SCHEMES.resolve_all(config.schemes)
    config.record.check_samples(MOST_SAMPLES)
    check_axes(CONTEST, config)
    WORLDS[config.motion.kind].check(config)
    _check_sensors(config)
    _check_times(config)


def check_outside(config: FloaterConfig) -> None:
    """Raise `InputError` if the file of a recorded motion cannot be used."""
    WORLDS[config.motion.kind].check_outside(config)


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
    periods = WORLDS[motion.kind].find_periods(motion)
    if not periods:
        return
    fastest = 1.0 / min(periods)
    require(
        sensors.optical_rate > 2.0 * fastest,
        f"sensors.optical_rate: {sensors.optical_rate:g} Hz does not show motion of {fastest:.3g} "
        f"Hz (waves, or the fastest resonance); give more than {2.0 * fastest:.3g} Hz",
    )
