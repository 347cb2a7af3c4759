"""Refuses settings that cannot work together, before a run. Each message says what would work.

Types and bounds of single keys are declared in `owtsweep.studies.hub.config` and `sections`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from owtsweep.config.section import fields_along
from owtsweep.errors import InputError, require
from owtsweep.studies.hub.conditions import find_world, require_spectrum
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.expected.checks import check_expected
from owtsweep.studies.hub.fix_rules import check_fix_rules
from owtsweep.studies.hub.listed import list_baselines, resolve_all
from owtsweep.studies.hub.sizes import GRAIN, check_fix_interval, check_grid

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: Longest record that fits a machine's memory: 1e8 steps take gigabytes.
MOST_STEPS = 100_000_000


def check(config: HubConfig) -> None:
    """Check that the settings of a run can work together.

    Raises
    ------
    InputError
        For the first setting that cannot work; the message says what would work.
    """
    check_grid(config)
    _check_sensors(config)
    _check_record(config)
    find_world(config).check(config)
    check_fix_rules(config)
    for scheme in resolve_all(config.schemes):
        _check_sections(config, scheme)
        scheme.check(config)
    _check_baselines(config)
    _check_tune(config)
    if config.engine == "expected":
        check_expected(config, resolve_all(config.schemes, config))
    if config.measures.extremes:
        require(
            config.evaluation == "direct",
            "measures.extremes: largest errors do not superpose; add evaluation=direct",
        )
    if config.measures.efficiency:
        from owtsweep.studies.hub.bounds.cells import check_high_pass

        require_spectrum(config, "measures.efficiency")
        check_high_pass(config)


def _check_tune(config: HubConfig) -> None:
    """Refuse a range of amplitudes for `tune` whose ends are reversed."""
    low, high = config.tune.amplitude or (0.0, 0.0)
    require(
        low <= high,
        f"tune.amplitude: the ends [{low:g}, {high:g}] m are reversed; use "
        f"tune.amplitude=[{high:g},{low:g}]",
    )


def _check_sections(config: HubConfig, scheme: Scheme) -> None:
    """Raise InputError unless the scheme's attribute `sections` is a list of existing keys.

    The keys are those of the configuration, e.g. "mkf" or "hme.mhe".
    """
    for section in scheme.sections:
        path = section.split(".")
        require(
            len(fields_along(type(config), path)) == len(path),
            f"schemes: {scheme.name} has sections = {scheme.sections!r}; give a tuple of keys of "
            'the configuration, e.g. ("mkf", "hme")',
        )


def _check_baselines(config: HubConfig) -> None:
    """Refuse a baseline that is named twice."""
    baselines = list_baselines(config)
    for name in baselines:
        require(
            baselines.count(name) == 1,
            f"baselines: {name} stands there twice; leave one of them out",
        )


def _check_sensors(config: HubConfig) -> None:
    gnss, imu = config.sensors.gnss, config.sensors.imu
    require(
        gnss.rate <= imu.rate,
        f"sensors.gnss.rate: {gnss.rate:g} Hz is above the IMU's {imu.rate:g} Hz; lower the rate "
        "of the GNSS, or raise sensors.imu.rate",
    )
    ratio = imu.rate / gnss.rate
    if abs(ratio - round(ratio)) > GRAIN * ratio:
        low, high = imu.rate / math.ceil(ratio), imu.rate / math.floor(ratio)
        raise InputError(
            f"sensors.gnss.rate: {gnss.rate:g} Hz does not divide the IMU's {imu.rate:g} Hz; use "
            f"{low:.10g} or {high:.10g}"
        )
    if imu.high_pass is not None:
        require(
            imu.high_pass < imu.rate / 2.0,
            f"sensors.imu.high_pass: {imu.high_pass:g} Hz is not below half of the IMU's rate, "
            f"{imu.rate / 2.0:g} Hz; use e.g. 0.01, or null for none",
        )
    check_fix_interval(round(ratio))
    _check_steps("sensors.gnss.delay", gnss.delay, imu.rate)


def _check_steps(key: str, value: float, rate: float) -> None:
    """Raise InputError if a time is not a whole number of IMU steps; suggest the two nearest times.

    `key` is the key of the time in the configuration, `value` the time in s, and `rate` the IMU's
    rate in Hz.
    """
    step = 1.0 / rate
    count = value / step
    if abs(count - round(count)) > GRAIN * max(1.0, count):
        low, high = math.floor(count) * step, math.ceil(count) * step
        raise InputError(
            f"{key}: {value:g} s is no multiple of the IMU step {step:g} s; use {low:.10g} or "
            f"{high:.10g}"
        )


def _check_record(config: HubConfig) -> None:
    imu = config.sensors.imu
    longest = MOST_STEPS / imu.rate
    require(
        config.record.duration <= longest,
        f"record.duration: {config.record.duration:g} s is longer than {longest:g} s "
        f"({MOST_STEPS:.0e} IMU steps); shorten the record",
    )
    _check_steps("record.duration", config.record.duration, imu.rate)
    require(
        config.sensors.gnss.delay < config.record.duration,
        f"sensors.gnss.delay: {config.sensors.gnss.delay:g} s is no shorter than record.duration "
        f"{config.record.duration:g} s; shorten the delay or lengthen the record",
    )
    require(
        config.measures.settling_time < config.record.duration,
        f"record.duration: {config.record.duration:g} s is no longer than measures.settling_time "
        f"{config.measures.settling_time:g} s; lengthen the record",
    )
