"""Refuses settings that cannot work together, before a run. Each message says what would work.

Types and bounds of single keys are declared in `owtsweep.studies.hub.config` and `sections`.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.config.section import fields_along
from owtsweep.errors import InputError, require
from owtsweep.motion.modulation import Modulation
from owtsweep.motion.spectra import spectrum
from owtsweep.motion.synthesis import line_numbers
from owtsweep.motion.tracking import LEAST
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.expected.checks import check_expected
from owtsweep.studies.hub.fix_rules import check_fix_rules
from owtsweep.studies.hub.names import list_baselines
from owtsweep.studies.hub.plant import check_plant, is_plant, require_spectrum
from owtsweep.studies.hub.resolving import resolve_all
from owtsweep.studies.hub.sizes import (
    check_buffers,
    check_fix_interval,
    check_grid,
    check_horizon,
)
from owtsweep.studies.hub.switching.checks import check_switch

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.studies.hub.scheme_sections import Mhe

logger = logging.getLogger(__name__)

#: Longest record that fits a machine's memory: 1e8 steps take gigabytes.
MOST_STEPS = 100_000_000
#: A time counts as a multiple of a step if it is one within this fraction of the step.
GRAIN = 1e-6
#: Least `Spectrum.peak_margin`, Hz: below it rounding makes the peak infinite.
LEAST_MARGIN = 1e-12


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
    check_plant(config)
    check_fix_rules(config)
    _check_envelope(config)
    if not is_plant(config):
        _check_band(config)
        _check_spectrum(config)
    if "SWITCH" in config.schemes:
        check_switch(config.switch)
    schemes = resolve_all(config.schemes, config)
    for scheme in schemes:
        _check_sections(config, scheme)
    _check_baselines(config, schemes)
    if any(scheme.name in ("HME1", "HME2") for scheme in schemes):
        _check_window(config, "hme.smoother_window", config.hme.smoother_window)
    if any(scheme.name == "HME2" for scheme in schemes):
        _check_mhe(config, config.hme.mhe)
    if any(scheme.name == "SKF" for scheme in schemes):
        _check_skf(config)
    if any(scheme.name == "SKFA" for scheme in schemes) and config.record.duration < LEAST:
        logger.warning(
            "schemes: SKFA chooses a spectrum after %g s; records of %g s leave it no time, so it "
            "assumes next to nothing of the motion",
            LEAST,
            config.record.duration,
        )
    _check_tune(config)
    if config.engine == "expected":
        check_expected(config, schemes)
    if config.measures.extremes:
        require(
            config.evaluation == "direct",
            "measures.extremes: largest errors do not superpose; add evaluation=direct",
        )
    if config.measures.efficiency:
        from owtsweep.studies.hub.bounds.cells import check_high_pass

        require_spectrum(config, "measures.efficiency")
        check_high_pass(config)


def _check_skf(config: HubConfig) -> None:
    """Raise InputError for settings with which SKF cannot work."""
    require_spectrum(config, "SKF")
    states = config.skf.states
    require(
        states % 2 == 0,
        f"skf.states: {states} is odd, and the states of a shaping filter come in pairs; use "
        f"{states - 1} or {states + 1}",
    )


def _check_tune(config: HubConfig) -> None:
    """Refuse a range of amplitudes for `tune` whose ends are reversed."""
    low, high = config.tune.amplitude or (0.0, 0.0)
    require(
        low <= high,
        f"tune.amplitude: the ends [{low:g}, {high:g}] m are reversed; use "
        f"tune.amplitude=[{high:g},{low:g}]",
    )


def _check_envelope(config: HubConfig) -> None:
    """Raise InputError for an amplitude envelope that is none, or with which no engine can work."""
    envelope = config.motion.envelope
    if envelope is None:
        return
    Modulation(envelope, "motion.envelope")
    require(
        not is_plant(config),
        "motion.envelope: the sea of motion=plant neither grows nor falls; leave out motion=plant, "
        "or use motion.envelope=null",
    )
    require(
        config.engine != "expected",
        "motion.envelope: engine=expected needs motion that neither grows nor falls; use "
        "engine=batch",
    )


def _check_sections(config: HubConfig, scheme: Scheme) -> None:
    """Raise InputError unless the scheme's attribute `sections` is a list of existing keys.

    The keys are those of the configuration, e.g. "mkf" or "hme.mhe". A scheme need not have this
    attribute.
    """
    sections = getattr(scheme, "sections", ())
    listed = isinstance(sections, list | tuple) and all(isinstance(name, str) for name in sections)
    for name in sections if listed else ():
        path = name.split(".")
        listed = listed and len(fields_along(type(config), path)) == len(path)
    require(
        listed,
        f"schemes: {scheme.name} has sections = {sections!r}; give a tuple of keys of the "
        'configuration, e.g. ("mkf", "hme")',
    )


def _check_baselines(config: HubConfig, schemes: Sequence[Scheme]) -> None:
    """Refuse a baseline that is named twice, or has the name of a user's scheme."""
    baselines = list_baselines(config)
    for name in baselines:
        require(
            baselines.count(name) == 1,
            f"baselines: {name} stands there twice; leave one of them out",
        )
        require(
            all(scheme.name != name for scheme in schemes),
            f"baselines: a scheme of yours is also named {name}; rename it, or leave {name} out of "
            "baselines",
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


def _check_band(config: HubConfig) -> None:
    band, imu = config.band, config.sensors.imu
    require(
        band[0] < band[1],
        f"band: the edges [{band[0]:g}, {band[1]:g}] Hz are reversed or equal; use "
        f"band=[{min(band):g},{max(band) if band[0] != band[1] else 2 * band[1]:g}]",
    )
    require(
        band[1] < imu.rate / 2.0,
        f"band: {band[1]:g} Hz is not below the Nyquist frequency {imu.rate / 2.0:g} Hz of the "
        "IMU; lower the upper edge, or raise sensors.imu.rate",
    )
    line_numbers((band[0], band[1]), 2.0 * config.record.duration)


def _check_spectrum(config: HubConfig) -> None:
    for period in config.grid.natural_period:
        of_period = spectrum(config.spectrum.kind, period, config.spectrum.bandwidth)
        peak = of_period.peak_frequency
        require(
            of_period.peak_margin > LEAST_MARGIN,
            f"spectrum.bandwidth: {config.spectrum.bandwidth:g} s^-2 leaves the peak at {period:g} "
            "s no width; use e.g. 6.7e-6 (1 % damping)",
        )
        require(
            config.band[0] <= peak <= config.band[1],
            f"grid.natural_period: {period:g} s has its peak at {peak:.3g} Hz, outside band "
            f"[{config.band[0]:g}, {config.band[1]:g}] Hz; widen band, or choose another period",
        )


def _check_window(config: HubConfig, key: str, window: int) -> None:
    steps = config.record.duration * config.sensors.imu.rate
    require(
        window < steps,
        f"{key}: {window} steps are longer than the record of {steps:.0f} steps; shorten the "
        "window",
    )
    check_buffers(key, window, round(config.sensors.gnss.delay * config.sensors.imu.rate))


def _check_mhe(config: HubConfig, mhe: Mhe) -> None:
    if mhe.smoother_window is not None:
        _check_window(config, "hme.mhe.smoother_window", mhe.smoother_window)
    imu, gnss = config.sensors.imu, config.sensors.gnss
    M = round(imu.rate / gnss.rate)
    steps = mhe.interval * imu.rate
    small = [d for d in range(1, math.isqrt(M) + 1) if M % d == 0]
    divisors = [*small, *(M // d for d in small)]
    if min(abs(steps - d) for d in divisors) > GRAIN * max(1.0, steps):
        low = max((d for d in divisors if d <= steps), default=1)
        high = min((d for d in divisors if d >= steps), default=M)
        values = " or ".join(f"{d / imu.rate:.10g}" for d in sorted({low, high}))
        raise InputError(
            f"hme.mhe.interval: {mhe.interval:g} s is not a whole number of IMU steps that divides "
            f"the GNSS interval {1.0 / gnss.rate:g} s; use {values}"
        )
    require(
        mhe.horizon / gnss.rate < config.record.duration,
        f"hme.mhe.horizon: {mhe.horizon} GNSS intervals ({mhe.horizon / gnss.rate:g} s) are longer "
        f"than the record of {config.record.duration:g} s; shorten the horizon",
    )
    check_horizon(mhe.horizon)
    require(
        mhe.arrival != "none" or mhe.horizon >= 2,
        "hme.mhe.arrival: 'none' needs at least 3 fixes in the window to determine position, "
        f"velocity and bias, and hme.mhe.horizon={mhe.horizon} holds {mhe.horizon + 1}; use "
        "hme.mhe.horizon=2 or more, or hme.mhe.arrival=mkf",
    )
