"""Checks that the values of the floater study's configuration can work together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.studies.base.axes import check_axes
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.sections import AXES

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig

#: Most samples of a record: of more, motion and estimates do not fit into memory.
MOST_SAMPLES = 1_000_000


def check(config: FloaterConfig) -> None:
    """Check everything that can be known before a record is made.

    Raises
    ------
    InputError
        If two values cannot work together; the message says what would work.
    """
    from owtsweep.studies.floater.checks_record import check_motion, check_sensors

    SCHEMES.resolve_all(config.schemes)
    config.record.check_samples(MOST_SAMPLES)
    check_axes(config.axes, config.grid, AXES, len(config.schemes))
    check_motion(config)
    check_sensors(config)
    _check_times(config)


def check_outside(config: FloaterConfig) -> None:
    """Raise `InputError` if the file of a recorded motion cannot be used."""
    from owtsweep.studies.floater.motion_recorded import read_motion

    motion, record = config.motion, config.record
    if motion.kind == "recorded":
        read_motion(motion, steps=record.steps, step=1.0 / record.rate, lead=0)


def _check_times(config: FloaterConfig) -> None:
    """Check that times that schemes are told lie within a record."""
    for tuning in config.by_tuning().values():
        for key, value in (
            ("lag", tuning.filters.lag),
            ("delay_declared", tuning.filters.delay_declared),
        ):
            require(
                value < config.record.duration,
                f"filters.{key}: {value:g} s are not shorter than the record of "
                f"{config.record.duration:g} s; give less",
            )
