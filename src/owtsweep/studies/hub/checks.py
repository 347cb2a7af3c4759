"""Refuses settings that cannot work, before a run. Each message says what would work.

Types and bounds of single keys are declared in `config` and `scheme_sections`. The estimates of
memory count the largest arrays only; at worst they are a few times too low.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import prod

from owtsweep.config.section import fields_along
from owtsweep.errors import require
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import SCHEMES, Scheme, list_baselines, resolve_all
from owtsweep.studies.hub.records import REPLICATES_PER_BLOCK, count_records_per_block
from owtsweep.studies.hub.scheme_sections import FilterTuning
from owtsweep.studies.hub.worlds import find_world, require_spectrum

#: Longest record that fits a machine's memory: 1e8 steps take gigabytes.
MOST_STEPS = 100_000_000
#: Sections of the configuration whose filter takes the fixes themselves, so that a gate can judge
#: them by the filter's covariance.
GATED = ("ekf", "mkf", "hme1")


def check(config: HubConfig) -> None:
    """Raise InputError for the first setting of a run that cannot work, and say what would work."""
    check_truth(config)
    check_fix_rules(config)
    for scheme in resolve_all(config.schemes):
        _check_sections(config, scheme)
        scheme.check(config)
    _check_baselines(config)
    _check_tune(config)
    if config.engine == "expected":
        check_expected(config, resolve_all(config.schemes, config))
    require(
        not config.measures.extremes or config.evaluation == "direct",
        "measures.extremes: largest errors do not superpose; add evaluation=direct",
    )
    if config.measures.efficiency:
        from owtsweep.studies.hub.bounds.cells import check_high_pass

        require_spectrum(config, "measures.efficiency")
        check_high_pass(config)


def check_truth(config: HubConfig) -> None:
    """Raise InputError for the first setting of grid, sensors, record or motion that cannot be."""
    check_grid(config)
    _check_sensors(config)
    _check_record(config)
    find_world(config).check(config)


def _check_tune(config: HubConfig) -> None:
    low, high = config.tune.amplitude or (0.0, 0.0)
    require(
        low <= high,
        f"tune.amplitude: the ends [{low:g}, {high:g}] m are reversed; use "
        f"tune.amplitude=[{high:g},{low:g}]",
    )


def _check_sections(config: HubConfig, scheme: Scheme) -> None:
    """Raise InputError unless `sections` of the scheme lists keys, e.g. "mkf" or "hme.mhe"."""
    for section in scheme.sections:
        path = section.split(".")
        require(
            len(fields_along(type(config), path)) == len(path),
            f"schemes: {scheme.name} has sections = {scheme.sections!r}; give a tuple of keys of "
            'the configuration, e.g. ("mkf", "hme")',
        )


def _check_baselines(config: HubConfig) -> None:
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
    require(
        abs(ratio - round(ratio)) <= GRAIN * ratio,
        f"sensors.gnss.rate: {gnss.rate:g} Hz does not divide the IMU's {imu.rate:g} Hz; use "
        f"{imu.rate / math.ceil(ratio):.10g} or {imu.rate / math.floor(ratio):.10g}",
    )
    if imu.high_pass is not None:
        require(
            imu.high_pass < imu.rate / 2.0,
            f"sensors.imu.high_pass: {imu.high_pass:g} Hz is not below half of the IMU's rate, "
            f"{imu.rate / 2.0:g} Hz; use e.g. 0.01, or null for none",
        )
    require(
        round(ratio) <= MOST_STEPS_BETWEEN_FIXES,
        f"sensors.gnss.rate: this rate leaves {round(ratio):.3g} IMU steps between fixes, more "
        f"than {MOST_STEPS_BETWEEN_FIXES}; raise this rate, or lower sensors.imu.rate",
    )
    _check_steps("sensors.gnss.delay", gnss.delay, imu.rate)


def _check_steps(key: str, value: float, rate: float) -> None:
    """Raise InputError if a time (s) is no whole number of IMU steps; suggest the two nearest.

    `key` is the key of the time in the configuration, `rate` the IMU's rate in Hz.
    """
    step = 1.0 / rate
    count = value / step
    require(
        abs(count - round(count)) <= GRAIN * max(1.0, count),
        f"{key}: {value:g} s is no multiple of the IMU step {step:g} s; use "
        f"{math.floor(count) * step:.10g} or {math.ceil(count) * step:.10g}",
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


def check_fix_rules(config: HubConfig) -> None:
    """Refuse gates that would judge fixes by a covariance that is no measure for them.

    HME2's is too small. That of some update rules does not grow while the gate refuses fixes, so
    the gate would not open again once the state has drifted.

    Raises InputError that names the first scheme with such a gate.
    """
    require(
        config.hme2.fix_rule != "gate",
        "hme2.fix_rule: HME2's filter takes each fix several times, by way of the window, so its "
        "covariance is too small to judge a fix by; use hme2.fix_rule=huber",
    )
    for section in GATED:
        tuning: FilterTuning = getattr(config, section)
        require(
            tuning.fix_rule != "gate" or tuning.update_rule in ("proper", "mask_columns"),
            f"{section}.fix_rule: a gate sticks with {section}.update_rule={tuning.update_rule}, "
            f"which treats a refused fix as taken; use {section}.update_rule=proper, or "
            f"{section}.fix_rule=huber",
        )


#: Most bytes that one part of a run may take.
MOST_BYTES = 4_000_000_000
#: Most blocks of a plan: each block is a file, and planning it takes 1.3 kB and 0.1 ms.
MOST_BLOCKS = 1_000_000
#: Most steps between fixes: gains are stored for each of them, 500 bytes per step and scheme.
MOST_STEPS_BETWEEN_FIXES = 500_000
#: Numbers per record (error measures times time windows), and bytes per number.
VALUES, NUMBER = 20, 8


def check_grid(config: HubConfig) -> None:
    """Raise InputError if the grid needs more than `MOST_BLOCKS` blocks or `MOST_BYTES` bytes."""
    world, schemes = find_world(config), len(SCHEMES.list_entries(config))
    periods, _, each, records = _count(config)
    words = {condition.name: condition.values_word for condition in world.conditions}
    blocks = schemes * periods * each * -(-records // count_records_per_block(config))
    require(
        config.engine == "expected" or blocks <= MOST_BLOCKS,
        f"{world.section}: a sweep would have {blocks:.3g} blocks of work, more than "
        f"{MOST_BLOCKS:.0e}; give fewer {', '.join(words.values())} or replicates",
    )
    needed, grid = count_table_bytes(config), world.get_grid(config)
    counted = " x ".join(f"{len(grid[name])} {word}" for name, word in words.items())
    require(
        needed <= MOST_BYTES,
        f"{world.section}: {counted} x {records} replicates need some {needed / 1e9:.3g} GB, more "
        f"than {MOST_BYTES / 1e9:g} GB; give fewer of them",
    )


def _count(config: HubConfig) -> tuple[int, int, int, int]:
    """Return numbers: of combinations of a record's conditions, of amplitudes, of runs, of records.

    Runs are those of a record, one at each amplitude unless they superpose.
    """
    world = find_world(config)
    grid = world.get_grid(config)
    of_record = [len(grid[each.name]) for each in world.conditions if not each.expands]
    amplitudes = prod(len(grid[each.name]) for each in world.conditions if each.expands)
    runs = amplitudes if config.evaluation == "direct" else 1
    records = 1 if config.engine == "expected" else config.grid.greatest
    return prod(of_record), amplitudes, runs, records


def count_table_bytes(config: HubConfig) -> int:
    """Return how many bytes the tables of a configuration need while they are made."""
    schemes = len(config.schemes)
    periods, amplitudes, each, records = _count(config)
    # bytes: the values of one scheme at one period, the rows of all records, the tables' lines
    values = NUMBER * VALUES * amplitudes * records
    rows = 3 * NUMBER * VALUES * schemes * periods * records * each
    lines = 10 * NUMBER * schemes * periods * amplitudes  # large expected grids: one measure
    lines *= 1 if config.engine == "expected" else VALUES
    return 3 * values + rows + lines


#: A time counts as a multiple of a step if it is one within this fraction of the step.
GRAIN = 1e-6


def check_window(config: HubConfig, key: str, window: int) -> None:
    """Raise InputError if a smoother's window, in steps, exceeds the record or the memory.

    A record is computed in pieces of twice the sum of window and delay, for 24 series at once.
    """
    steps = config.record.duration * config.sensors.imu.rate
    require(
        window < steps,
        f"{key}: {window} steps are longer than the record of {steps:.0f} steps; shorten the "
        "window",
    )
    delay = round(config.sensors.gnss.delay * config.sensors.imu.rate)
    chunk = 2 * (window + delay)
    needed = 3 * NUMBER * REPLICATES_PER_BLOCK * (6 * (window + chunk) + 4 * chunk + 6 * window)
    require(
        needed <= MOST_BYTES,
        f"{key}: {window} steps, and {delay} steps of sensors.gnss.delay, need some "
        f"{needed / 1e9:.3g} GB, more than {MOST_BYTES / 1e9:g} GB; shorten the window or delay",
    )


def check_mhe(config: HubConfig) -> None:
    """Raise InputError for an interval, horizon or arrival cost with which the MHE cannot work."""
    mhe = config.hme.mhe
    if mhe.smoother_window is not None:
        check_window(config, "hme.mhe.smoother_window", mhe.smoother_window)
    imu, gnss = config.sensors.imu, config.sensors.gnss
    M = round(imu.rate / gnss.rate)
    steps = mhe.interval * imu.rate
    divisors = [d for d in range(1, M + 1) if M % d == 0]
    low = max((d for d in divisors if d <= steps), default=1)
    high = min((d for d in divisors if d >= steps), default=M)
    values = " or ".join(f"{d / imu.rate:.10g}" for d in sorted({low, high}))
    require(
        min(abs(steps - d) for d in divisors) <= GRAIN * max(1.0, steps),
        f"hme.mhe.interval: {mhe.interval:g} s is not a whole number of IMU steps that divides the "
        f"GNSS interval {1.0 / gnss.rate:g} s; use {values}",
    )
    require(
        mhe.horizon / gnss.rate < config.record.duration,
        f"hme.mhe.horizon: {mhe.horizon} GNSS intervals ({mhe.horizon / gnss.rate:g} s) are longer "
        f"than the record of {config.record.duration:g} s; shorten the horizon",
    )
    needed = 12 * NUMBER * mhe.horizon**2  # its matrices
    require(
        needed <= MOST_BYTES,
        f"hme.mhe.horizon: {mhe.horizon} GNSS intervals need some {needed / 1e9:.3g} GB, more than "
        f"{MOST_BYTES / 1e9:g} GB; shorten the horizon",
    )
    require(
        mhe.arrival != "none" or mhe.horizon >= 2,
        "hme.mhe.arrival: 'none' needs at least 3 fixes in the window to determine position, "
        f"velocity and bias, and hme.mhe.horizon={mhe.horizon} holds {mhe.horizon + 1}; use "
        "hme.mhe.horizon=2 or more, or hme.mhe.arrival=mkf",
    )


def check_expected(config: HubConfig, schemes: Sequence[Scheme]) -> None:
    """Raise InputError for settings with which the engine `expected` cannot work."""
    require(
        not config.measures.extremes,
        "measures.extremes: largest errors need records; use engine=batch",
    )
    require(
        config.evaluation == "superposed",
        "evaluation: engine=expected runs no record, so it cannot run amplitudes directly; use "
        "evaluation=superposed, or engine=batch",
    )
    require(
        config.sensors.imu.high_pass is None,
        "sensors.imu.high_pass: engine=expected cannot shift the phase of the force, as an AC "
        "coupling does; use engine=batch",
    )
    gnss = config.sensors.gnss
    faults = {
        "outliers": gnss.outliers.rate > 0.0,
        "loss": gnss.loses,
        "correlation": gnss.correlation.sigma > 0.0,
    }
    for fault, there in faults.items():
        require(
            not there,
            f"sensors.gnss.{fault}: engine=expected knows white noise of fixes that all arrive; "
            f"use engine=batch, or leave {fault} at its default",
        )
    for scheme in schemes:
        if scheme.expected_in_cell:
            _check_skf(config, scheme.name)
            continue
        require(
            scheme.linear and scheme.batched == "chain",
            f"schemes: {scheme.name} has no kernel or is not linear, and engine=expected needs a "
            "linear scheme with a kernel; use `sweep` with engine=batch, or leave the scheme out "
            "(HME2 is linear if hme.mhe.constraints is null, every scheme only with "
            "fix_rule=plain)",
        )


def _check_skf(config: HubConfig, name: str) -> None:
    """Raise InputError unless SKF has errors that do not depend on the length of the record."""
    require(
        config.measures.window == "settled",
        f"measures.window: engine=expected knows the errors of {name} once they have settled, not "
        f"those of its start; use measures.window=settled, or leave {name} out of schemes",
    )
    walk = config.sensors.imu.bias_walk if config.skf.q_b is None else config.skf.q_b
    require(
        walk > 0.0,
        f"schemes: without a bias walk {name} never settles, so engine=expected has no error to "
        "tell; give skf.q_b above zero, e.g. skf.q_b=1e-6, or leave SKF out of schemes",
    )
