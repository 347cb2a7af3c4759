"""Refuses settings that fit no record, or need more memory than machines have.

The estimates of memory count the largest arrays only. At worst they are a few times too low.
Settings that make sense stay far below the bounds.
"""

from __future__ import annotations

import math
from math import prod
from typing import TYPE_CHECKING

from owtsweep.errors import InputError, require
from owtsweep.studies.hub.conditions import find_world
from owtsweep.studies.hub.listed import list_entries
from owtsweep.studies.hub.records import REPLICATES_PER_BLOCK, count_records_per_block

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig


#: Most bytes that one part of a run may take.
MOST_BYTES = 4_000_000_000
#: Most blocks of a plan: each block is a file, and planning it takes 1.3 kB and 0.1 ms.
MOST_BLOCKS = 1_000_000
#: Most steps between fixes: gains are stored for each of them, 500 bytes per step and scheme.
MOST_STEPS_BETWEEN_FIXES = 500_000
#: Numbers per record (error measures times time windows), and bytes per number.
VALUES, NUMBER = 20, 8


def check_grid(config: HubConfig) -> None:
    """Raise InputError if the grid needs too many blocks (units of work), or too much memory.

    The bounds are `MOST_BLOCKS` blocks, and `MOST_BYTES` bytes for rows and tables.
    """
    grid, schemes = config.grid, len(list_entries(config))
    periods, amplitudes = _count_conditions(config)
    world = find_world(config)
    key, words = world.section, world.words
    counted = world.counted.format(periods, amplitudes)
    records = 1 if config.engine == "expected" else grid.replicates
    each = amplitudes if config.evaluation == "direct" else 1
    blocks = schemes * periods * each * -(-records // count_records_per_block(config))
    require(
        config.engine == "expected" or blocks <= MOST_BLOCKS,
        f"{key}: a sweep would have {blocks:.3g} blocks of work, more than {MOST_BLOCKS:.0e}; give "
        f"fewer {words} or replicates",
    )
    needed = count_table_bytes(config)
    require(
        needed <= MOST_BYTES,
        f"{key}: {counted} x {records} replicates need some {needed / 1e9:.3g} GB, more than "
        f"{MOST_BYTES / 1e9:g} GB; give fewer of them",
    )


def _count_conditions(config: HubConfig) -> tuple[int, int]:
    """Return the number of combinations of a record's conditions, and the number of amplitudes."""
    world = find_world(config)
    grid = world.get_grid(config)
    of_record = [len(grid[each.name]) for each in world.conditions if not each.expands]
    return prod(of_record), prod(len(grid[each.name]) for each in world.conditions if each.expands)


def count_table_bytes(config: HubConfig) -> int:
    """Return how many bytes the tables of a configuration need while they are made."""
    grid, schemes = config.grid, len(config.schemes)
    periods, amplitudes = _count_conditions(config)
    records = 1 if config.engine == "expected" else grid.replicates
    each = amplitudes if config.evaluation == "direct" else 1
    # bytes: the values of one scheme at one period, the rows of all records, the tables' lines
    values = NUMBER * VALUES * amplitudes * records
    rows = 3 * NUMBER * VALUES * schemes * periods * records * each
    lines = 10 * NUMBER * schemes * periods * amplitudes  # large expected grids: one measure
    lines *= 1 if config.engine == "expected" else VALUES
    return 3 * values + rows + lines


def check_fix_interval(steps: int) -> None:
    """Raise InputError if there are too many IMU steps between position fixes.

    A filter's gains are stored for each of the `steps` IMU steps between two position fixes.
    """
    require(
        steps <= MOST_STEPS_BETWEEN_FIXES,
        f"sensors.gnss.rate: this rate leaves {steps:.3g} IMU steps between fixes, more than "
        f"{MOST_STEPS_BETWEEN_FIXES}; raise this rate, or lower sensors.imu.rate",
    )


def check_buffers(key: str, window: int, delay: int) -> None:
    """Raise InputError if the buffers that a smoother needs do not fit into memory.

    A record is computed in pieces of twice the sum of `window` and `delay`, for 24 series at once.

    Parameters
    ----------
    key
        The key of the window in the configuration, for the message.
    window
        Length of the smoother's window in IMU steps.
    delay
        Delay of the GNSS in IMU steps.
    """
    chunk = 2 * (window + delay)
    needed = 3 * NUMBER * REPLICATES_PER_BLOCK * (6 * (window + chunk) + 4 * chunk + 6 * window)
    require(
        needed <= MOST_BYTES,
        f"{key}: {window} steps, and {delay} steps of sensors.gnss.delay, need some "
        f"{needed / 1e9:.3g} GB, more than {MOST_BYTES / 1e9:g} GB; shorten the window or delay",
    )


def check_horizon(intervals: int) -> None:
    """Raise InputError if the matrices of the MHE's windows do not fit into memory.

    `intervals` is the length of a window in GNSS intervals.
    """
    needed = 12 * NUMBER * intervals**2
    require(
        needed <= MOST_BYTES,
        f"hme.mhe.horizon: {intervals} GNSS intervals need some {needed / 1e9:.3g} GB, more than "
        f"{MOST_BYTES / 1e9:g} GB; shorten the horizon",
    )


#: A time counts as a multiple of a step if it is one within this fraction of the step.
GRAIN = 1e-6


def check_window(config: HubConfig, key: str, window: int) -> None:
    """Refuse a smoother's window that is longer than the record, or needs too much memory.

    `key` is the key of the window in the configuration, `window` its length in IMU steps.

    Raises
    ------
    InputError
        If so.
    """
    steps = config.record.duration * config.sensors.imu.rate
    require(
        window < steps,
        f"{key}: {window} steps are longer than the record of {steps:.0f} steps; shorten the "
        "window",
    )
    check_buffers(key, window, round(config.sensors.gnss.delay * config.sensors.imu.rate))


def check_mhe(config: HubConfig) -> None:
    """Refuse an interval, a horizon or an arrival cost with which the MHE cannot work.

    Raises
    ------
    InputError
        If there is one; the message says what would work.
    """
    mhe = config.hme.mhe
    if mhe.smoother_window is not None:
        check_window(config, "hme.mhe.smoother_window", mhe.smoother_window)
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
