"""Reads a recorded motion of six degrees of freedom as a truth.

The file has a column of time and six of positions: x, y, z in m, phi, theta, psi in rad (or in the
units that the file or the configuration states). Velocities and accelerations are those of a spline
of degree 5 through the positions, so that all three are exact derivatives of each other. Columns u,
v, w, p, q, r (derivatives of the six, in the basin's frame as in section 2.3) and ax, ay, az
(accelerations there) take their place where the file has them.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require, shorten
from owtsweep.io.reading import expand_home
from owtsweep.motion.lines import Series, Span
from owtsweep.motion.recorded.checks import require_possible
from owtsweep.motion.recorded.columns import name_signals
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.units import find_factor_to
from owtsweep.studies.floater.config import Motion as MotionSection
from owtsweep.studies.floater.contract import DOF

#: Names of the columns of velocities and accelerations; all signals but time.
VELOCITIES, ACCELERATIONS = ("u", "v", "w", "p", "q", "r"), ("ax", "ay", "az")
SIGNALS = (*DOF, *VELOCITIES, *ACCELERATIONS)
#: A row may be off its time by this part of a step, because times are rounded; the mean step may
#: differ from the record's by the second one.
UNEVEN, OTHER_STEP = 0.05, 1e-3
#: Pitch in rad beyond which rates of Euler angles lose their meaning (89 degrees).
STEEPEST = np.deg2rad(89.0)


def read_motion(
    motion: MotionSection, stream: object, span: Span, roll: float | None = None
) -> Series:
    """Read a recorded motion; before the record it rests at its first position.

    Parameters
    ----------
    motion
        The section `motion`, with a file.
    stream, roll
        Not used: nothing is random, and the roll is that of the file.
    span
        The samples that are taken from the file's beginning, and the lead before them.

    Raises
    ------
    InputError
        If the file cannot be used, lacks a column, is too short, or has another step.
    """
    steps, step, lead = span
    table = open_table(expand_home(str(motion.file)))
    columns = _find_columns(motion.columns, table)
    loaded = table.load(list(dict.fromkeys(column for column, _ in columns.values())), None)
    clock, unit = columns["time"]
    time = loaded[clock] * find_factor_to("s", unit, f"{table.path}: {clock}")
    _check_time(table, clock, time, steps, step)

    def take(name: str, wanted: str) -> Array:
        column, unit = columns[name]
        factor = find_factor_to(wanted, unit, f"{table.path}: column {column}")
        values = loaded[column][:steps] * factor
        require(
            bool(np.isfinite(values).all()),
            f"{table.path}: column {column} lacks numbers; fill the gaps or cut the record there",
        )
        require_possible(
            f"{table.path}: column {column}", values, "check its unit, and mend damaged rows"
        )
        require(
            bool(np.any(values != values[0])),
            f"{table.path}: column {column} is {values[0]:g} throughout, and errors are told "
            f"relative to the motion of {name}; record it, or put small noise in its place",
        )
        return np.asarray(values)

    position = np.column_stack([take(n, "m" if n in "xyz" else "rad") for n in DOF])
    steepest = float(np.abs(position[:, DOF.index("theta")]).max())
    require(
        steepest < STEEPEST,
        f"{table.path}: column {columns['theta'][0]} reaches {steepest:g} rad, where Euler "
        "angles fail; if angles are in degrees, say so: motion.columns=[phi:NAME:deg,"
        "theta:NAME:deg,psi:NAME:deg]",
    )
    velocity, acceleration = _derive(position, step)
    for names, array, unit in (
        (VELOCITIES, velocity, "m/s"), (ACCELERATIONS, acceleration, "m/s^2"),
    ):  # fmt: skip
        for number, name in enumerate(names):
            if name in columns:
                array[:, number] = take(name, unit if number < 3 else "rad/s")
    rest = np.zeros((lead, 6))
    return Series(
        np.concatenate([np.repeat(position[:1], lead, axis=0), position]),
        np.concatenate([rest, velocity]),
        np.concatenate([rest, acceleration]),
    )


def _find_columns(given: list[str], table: ChannelTable) -> dict[str, tuple[str, str]]:
    """Return signal -> name and unit of its column; all of `DOF` and time have one."""
    listed = f"it has {shorten(', '.join(table.names), 300)}"
    for item in given:
        signal, *named = item.split(":")
        require(
            signal in {*SIGNALS, "time"} and len(named) in (1, 2),
            f"motion.columns: {item!r} is not SIGNAL:NAME or SIGNAL:NAME:UNIT; signals are time, "
            f"{', '.join(SIGNALS)}",
        )
        require(
            named[0] in table.names,
            f"motion.columns: {table.path} has no column {named[0]!r}; {listed}",
        )
    columns = name_signals(table, SIGNALS, given)
    for name in DOF:
        require(
            name in columns,
            f"{table.path}: no column {name!r}; {listed}; name it by motion.columns=[{name}:NAME]",
        )
    require(
        "time" in columns,
        f"{table.path}: no column of time; call one `time`, or name it by "
        "motion.columns=[time:NAME]",
    )
    return columns


def _check_time(table: ChannelTable, clock: str, time: Array, steps: int, step: float) -> None:
    intervals = np.diff(time)
    require(
        len(time) > 1 and bool(np.isfinite(time).all()) and bool(np.all(intervals > 0.0)),
        f"{table.path}: column {clock} must increase from row to row",
    )
    own = float((time[-1] - time[0]) / (len(time) - 1))
    off = np.abs(time - time[0] - own * np.arange(len(time)))
    require(
        bool(off.max() <= UNEVEN * own),
        f"{table.path}: rows are not equally spaced in time (row {np.argmax(off) + 1} is off by "
        f"{off.max():.3g} s); resample the record first",
    )
    require(
        abs(own - step) <= OTHER_STEP * step,
        f"record.rate: {1.0 / step:g} Hz, but {table.path} has a row every {own:g} s; set "
        f"record.rate={1.0 / own:.6g}",
    )
    longest = np.floor(100.0 * len(time) * own) / 100.0
    require(
        len(time) >= steps,
        f"record.duration: {steps * step:g} s, but {table.path} lasts {longest:g} s; set "
        f"record.duration={longest:.10g}",
    )


def _derive(position: Array, step: float) -> tuple[Array, Array]:
    """Return first and second derivatives of a spline of degree 5 through positions."""
    from scipy.interpolate import make_interp_spline

    time = step * np.arange(len(position))
    spline = make_interp_spline(time, position, k=5)
    return np.asarray(spline(time, 1)), np.asarray(spline(time, 2))
