"""Refuses settings whose run would need more memory than machines have, before it is asked for.

The estimates count the largest arrays only. They are a few times too low at worst, and settings
that make sense stay far below the bounds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.errors import require

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: Replicates of one block: 0-7, 8-15, ... They run side by side, in eight lanes.
REPLICATES_PER_BLOCK = 8
#: Most bytes that one part of a run may take.
MOST_BYTES = 4_000_000_000
#: Most blocks of a plan: each is a file, and takes 1.3 kB and 0.1 ms to plan.
MOST_BLOCKS = 1_000_000
#: Most steps between fixes: gains are stored for each of them, 500 bytes per step and scheme.
MOST_STEPS_BETWEEN_FIXES = 500_000
#: Measures times windows of a record, and bytes of a number.
VALUES, NUMBER = 20, 8


def check_grid(config: HubConfig) -> None:
    """Refuse a grid whose plan or tables do not fit into memory."""
    grid, schemes = config.grid, len(config.schemes)
    periods, amplitudes = len(grid.natural_period), len(grid.amplitude)
    records = 1 if config.engine == "expected" else grid.replicates
    each = amplitudes if config.evaluation == "direct" else 1
    blocks = schemes * periods * each * -(-records // REPLICATES_PER_BLOCK)
    require(
        config.engine == "expected" or blocks <= MOST_BLOCKS,
        f"grid: it makes {blocks:.3g} blocks of work, more than {MOST_BLOCKS:.0e}; give fewer "
        "natural periods, amplitudes or replicates",
    )
    # the values of one scheme at one period, the rows of all records, and the lines of the tables
    values = NUMBER * VALUES * amplitudes * records
    rows = 3 * NUMBER * VALUES * schemes * periods * records * each
    lines = 10 * NUMBER * schemes * periods * amplitudes  # in large expected maps of one measure
    lines *= 1 if config.engine == "expected" else VALUES
    needed = 3 * values + rows + lines
    require(
        needed <= MOST_BYTES,
        f"grid: {periods} natural periods x {amplitudes} amplitudes x {records} replicates need "
        f"some {needed / 1e9:.3g} GB, more than {MOST_BYTES / 1e9:g} GB; give fewer of them",
    )


def check_fix_interval(steps: int) -> None:
    """Refuse more steps between fixes than a schedule of gains can hold."""
    require(
        steps <= MOST_STEPS_BETWEEN_FIXES,
        f"sensors.gnss.rate: it leaves {steps:.3g} IMU steps between fixes, more than "
        f"{MOST_STEPS_BETWEEN_FIXES}; raise it, or lower sensors.imu.rate",
    )


def check_buffers(key: str, window: int, delay: int) -> None:
    """Refuse a smoother's window whose buffers (`kernels.layout`) do not fit into memory.

    A chunk is twice as long as the window and the delay; three groups of eight lanes are run.
    """
    chunk = 2 * (window + delay)
    needed = 3 * NUMBER * REPLICATES_PER_BLOCK * (6 * (window + chunk) + 4 * chunk + 6 * window)
    require(
        needed <= MOST_BYTES,
        f"{key}: {window} steps, and {delay} steps of sensors.gnss.delay, need some "
        f"{needed / 1e9:.3g} GB, more than {MOST_BYTES / 1e9:g} GB; shorten one of them",
    )


def check_horizon(intervals: int) -> None:
    """Refuse an MHE's window whose maps do not fit into memory."""
    needed = 12 * NUMBER * intervals**2
    require(
        needed <= MOST_BYTES,
        f"hme.mhe.horizon: {intervals} GNSS intervals need some {needed / 1e9:.3g} GB, more than "
        f"{MOST_BYTES / 1e9:g} GB; shorten it",
    )
