"""What cannot work is refused before anything runs: one line each, with what would work."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.estimation.discretisation import METHODS
from owtsweep.estimation.gains import RULES
from owtsweep.motion.spectra import spectrum
from owtsweep.motion.synthesis import NORMALISATIONS, lines
from owtsweep.studies.hub.schemes import resolve_all

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import FilterTuning, HubConfig, Mhe, Variance

MODELS = ("sigma1", "sigma2")
EVALUATIONS = ("superposed", "direct")
WINDOWS = ("full", "settled")
CRITERIA = ("position", "velocity", "x", "y")
ACCURACIES = ("sigma", "bound")
ARRIVALS = ("mkf", "fixed", "none")
WEIGHTS = ("diagonal", "full")
SOLVERS = ("qrqp", "ipopt")
INPUTS = ("all", "averaged", "sampled")
VARIANCE_RULES = ("sigma2", "sigma2_over_step", "sigma2_times_ratio")

#: What fits a machine: a record of 1e8 steps holds gigabytes, a plan of 1e6 replicates millions
#: of cases.
MOST_STEPS = 100_000_000
MOST_REPLICATES = 1_000_000

#: Times are multiples of a step up to this fraction of it.
GRAIN = 1e-6


def check(config: HubConfig) -> None:
    """Raise `InputError` for the first thing that cannot work."""
    one_of("evaluation", config.evaluation, EVALUATIONS)
    one_of("normalise", config.normalise, NORMALISATIONS)
    one_of("measures.window", config.measures.window, WINDOWS)
    one_of("measures.criterion", config.measures.criterion, CRITERIA)
    one_of("sensors.accuracy", config.sensors.accuracy, ACCURACIES)
    _check_grid(config)
    _check_sensors(config)
    _check_record(config)
    _check_spectrum(config)
    for name in ("ekf", "mkf", "hme1", "hme2"):
        _check_filter(name, getattr(config, name))
    schemes = resolve_all(config.schemes, config)
    if any(scheme.name in ("HME1", "HME2") for scheme in schemes):
        _check_window(config, "hme.smoother_window", config.hme.smoother_window)
    if any(scheme.name == "HME2" for scheme in schemes):
        _check_mhe(config, config.hme.mhe)
    if config.engine == "expected":
        from owtsweep.studies.hub.expected.checks import check as check_expected

        check_expected(config)
    if config.measures.extremes:
        require(
            config.evaluation == "direct",
            "measures.extremes: largest errors do not superpose; add evaluation=direct",
        )


def one_of(key: str, value: str, options: Sequence[str]) -> None:
    """Refuse a value that is not among the options."""
    require(value in options, f"{key}: {value!r} is none of {', '.join(options)}")


def positive(key: str, value: float, unit: str) -> None:
    """Refuse zero, negative and infinite values."""
    require(
        math.isfinite(value) and value > 0.0,
        f"{key}: {value:g} {unit} must be a finite number above zero".replace("  ", " "),
    )


def not_negative(key: str, value: float, unit: str) -> None:
    """Refuse negative and infinite values."""
    require(
        math.isfinite(value) and value >= 0.0,
        f"{key}: {value:g} {unit} must be a finite number, zero or above".replace("  ", " "),
    )


def multiple(key: str, value: float, step: float, name: str) -> int:
    """How many steps a time is.

    Raises
    ------
    InputError
        If it is no whole number of steps, with the two nearest values that are.
    """
    count = value / step
    if abs(count - round(count)) > GRAIN * max(1.0, count):
        low, high = math.floor(count) * step, math.ceil(count) * step
        raise InputError(
            f"{key}: {value:g} s is no multiple of the {name} {step:g} s; use {low:.10g} or "
            f"{high:.10g}"
        )
    return round(count)


def _check_grid(config: HubConfig) -> None:
    for key, values, unit in (
        ("grid.natural_period", config.grid.natural_period, "s"),
        ("grid.amplitude", config.grid.amplitude, "m"),
    ):
        require(len(values) > 0, f"{key}: the list is empty; give at least one value, in {unit}")
        for value in values:
            positive(key, value, unit)
        require(len(set(values)) == len(values), f"{key}: a value stands there twice; list it once")
    require(
        config.grid.replicates >= 1,
        f"grid.replicates: {config.grid.replicates} must be at least 1",
    )
    require(
        config.grid.replicates <= MOST_REPLICATES,
        f"grid.replicates: {config.grid.replicates:.3g} is more than {MOST_REPLICATES}; lower it",
    )


def _check_sensors(config: HubConfig) -> None:
    gnss, imu = config.sensors.gnss, config.sensors.imu
    positive("sensors.gnss.sigma", gnss.sigma, "m")
    positive("sensors.imu.sigma", imu.sigma, "m/s^2")
    positive("sensors.gnss.rate", gnss.rate, "Hz")
    positive("sensors.imu.rate", imu.rate, "Hz")
    not_negative("sensors.gnss.delay", gnss.delay, "s")
    not_negative("sensors.imu.bias_walk", imu.bias_walk, "m/s^2/sqrt(s)")
    require(
        math.isfinite(imu.bias_initial),
        f"sensors.imu.bias_initial: {imu.bias_initial} must be a finite number",
    )
    require(
        len(config.sensors.gravity) == 2 and all(map(math.isfinite, config.sensors.gravity)),
        f"sensors.gravity: {list(config.sensors.gravity)} must be two numbers, north and east, "
        "in m/s^2",
    )
    for key, angle in (
        ("sensors.yaw", config.sensors.yaw),
        ("wave_direction", config.wave_direction),
    ):
        require(math.isfinite(angle), f"{key}: {angle} deg must be a finite number")
    require(
        gnss.rate <= imu.rate,
        f"sensors.gnss.rate: {gnss.rate:g} Hz is above the IMU's {imu.rate:g} Hz; lower it, or "
        "raise sensors.imu.rate",
    )
    ratio = imu.rate / gnss.rate
    if abs(ratio - round(ratio)) > GRAIN * ratio:
        low, high = imu.rate / math.ceil(ratio), imu.rate / math.floor(ratio)
        raise InputError(
            f"sensors.gnss.rate: {gnss.rate:g} Hz does not divide the IMU's {imu.rate:g} Hz; use "
            f"{low:.10g} or {high:.10g}"
        )
    multiple("sensors.gnss.delay", gnss.delay, 1.0 / imu.rate, "IMU step")


def _check_record(config: HubConfig) -> None:
    imu = config.sensors.imu
    positive("record.duration", config.record.duration, "s")
    longest = MOST_STEPS / imu.rate
    require(
        config.record.duration <= longest,
        f"record.duration: {config.record.duration:g} s is longer than {longest:g} s "
        f"({MOST_STEPS:.0e} IMU steps); shorten it",
    )
    multiple("record.duration", config.record.duration, 1.0 / imu.rate, "IMU step")
    require(
        config.sensors.gnss.delay < config.record.duration,
        f"sensors.gnss.delay: {config.sensors.gnss.delay:g} s is no shorter than record.duration "
        f"{config.record.duration:g} s; shorten the delay or lengthen the record",
    )
    not_negative("measures.settling_time", config.measures.settling_time, "s")
    require(
        config.measures.settling_time < config.record.duration,
        f"record.duration: {config.record.duration:g} s is no longer than measures.settling_time "
        f"{config.measures.settling_time:g} s; lengthen the record",
    )
    band = config.band
    require(len(band) == 2, f"band: {list(band)} must be two edges in Hz, e.g. band=[0.05,0.6]")
    positive("band", band[0], "Hz")
    require(
        band[0] < band[1],
        f"band: the edges [{band[0]:g}, {band[1]:g}] Hz are reversed or equal; use "
        f"band=[{min(band):g},{max(band) if band[0] != band[1] else 2 * band[1]:g}]",
    )
    require(
        band[1] < imu.rate / 2.0,
        f"band: {band[1]:g} Hz is not below the Nyquist frequency {imu.rate / 2.0:g} Hz of the "
        "IMU; lower it, or raise sensors.imu.rate",
    )
    lines((band[0], band[1]), 2.0 * config.record.duration)


def _check_spectrum(config: HubConfig) -> None:
    positive("spectrum.bandwidth", config.spectrum.bandwidth, "s^-2")
    for period in config.grid.natural_period:
        peak = spectrum(config.spectrum.kind, period, config.spectrum.bandwidth).peak_frequency
        require(
            config.band[0] <= peak <= config.band[1],
            f"grid.natural_period: {period:g} s has its peak at {peak:.3g} Hz, outside band "
            f"[{config.band[0]:g}, {config.band[1]:g}] Hz; widen band, or choose another period",
        )


def _check_variance(key: str, rule: Variance) -> None:
    one_of(f"{key}.rule", rule.rule, VARIANCE_RULES)
    positive(f"{key}.scale", rule.scale, "")


def _check_filter(key: str, tuning: FilterTuning) -> None:
    one_of(f"{key}.model", tuning.model, MODELS)
    one_of(f"{key}.discretisation", tuning.discretisation, METHODS)
    one_of(f"{key}.update_rule", tuning.update_rule, RULES)
    not_negative(f"{key}.q_a", tuning.q_a, "(m/s^3)^2/Hz")
    if tuning.q_b is not None:
        not_negative(f"{key}.q_b", tuning.q_b, "(m/s^2)^2/s")
    _check_variance(f"{key}.r_gnss", tuning.r_gnss)
    _check_variance(f"{key}.r_imu", tuning.r_imu)
    require(
        len(tuning.p0) == 4 and all(0.0 < value < math.inf for value in tuning.p0),
        f"{key}.p0: {list(tuning.p0)} must be four finite variances above zero "
        "(position, velocity, acceleration, bias)",
    )


def _check_window(config: HubConfig, key: str, window: int) -> None:
    require(window >= 0, f"{key}: {window} steps is negative; use 0 for no smoother")
    steps = config.record.duration * config.sensors.imu.rate
    require(
        window < steps,
        f"{key}: {window} steps are longer than the record of {steps:.0f} steps; shorten it",
    )


def _check_mhe(config: HubConfig, mhe: Mhe) -> None:
    one_of("hme.mhe.arrival", mhe.arrival, ARRIVALS)
    one_of("hme.mhe.inputs", mhe.inputs, INPUTS)
    one_of("hme.mhe.weights", mhe.weights, WEIGHTS)
    one_of("hme.mhe.solver", mhe.solver, SOLVERS)
    _check_variance("hme.mhe.r_fix", mhe.r_fix)
    for key, value in (("q_a", mhe.q_a), ("q_b", mhe.q_b)):
        if value is not None:
            positive(f"hme.mhe.{key}", value, "")
    require(
        len(mhe.p0) == 3 and all(0.0 < value < math.inf for value in mhe.p0),
        f"hme.mhe.p0: {list(mhe.p0)} must be three finite variances above zero "
        "(position, velocity, bias)",
    )
    if mhe.smoother_window is not None:
        _check_window(config, "hme.mhe.smoother_window", mhe.smoother_window)
    if mhe.constraints is not None:
        for key, unit in (("position", "m"), ("velocity", "m/s"), ("bias", "m/s^2")):
            bound = getattr(mhe.constraints, key)
            if bound is not None:
                positive(f"hme.mhe.constraints.{key}", bound, unit)
    imu, gnss = config.sensors.imu, config.sensors.gnss
    M = round(imu.rate / gnss.rate)
    positive("hme.mhe.interval", mhe.interval, "s")
    steps = mhe.interval * imu.rate
    divisors = [d for d in range(1, M + 1) if M % d == 0]
    if min(abs(steps - d) for d in divisors) > GRAIN * max(1.0, steps):
        low = max((d for d in divisors if d <= steps), default=1)
        high = min((d for d in divisors if d >= steps), default=M)
        values = " or ".join(f"{d / imu.rate:.10g}" for d in sorted({low, high}))
        raise InputError(
            f"hme.mhe.interval: {mhe.interval:g} s is no number of IMU steps that divides the GNSS "
            f"interval {1.0 / gnss.rate:g} s; use {values}"
        )
    require(mhe.horizon >= 1, f"hme.mhe.horizon: {mhe.horizon} must be at least 1 GNSS interval")
    require(
        mhe.horizon / gnss.rate < config.record.duration,
        f"hme.mhe.horizon: {mhe.horizon} GNSS intervals ({mhe.horizon / gnss.rate:g} s) are longer "
        f"than the record of {config.record.duration:g} s; shorten it",
    )
    require(
        mhe.arrival != "none" or mhe.horizon >= 2,
        "hme.mhe.arrival: 'none' needs at least 3 fixes in the window to determine position, "
        f"velocity and bias, and hme.mhe.horizon={mhe.horizon} holds {mhe.horizon + 1}; use "
        "hme.mhe.horizon=2 or more, or hme.mhe.arrival=mkf",
    )
