"""Check a recording. The message of an error is one line that names the file and the channel."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.formats.table import MOST_STEPS
from owtsweep.motion.recorded.recording import Recording, describe_jitter, fit_comb

#: An axis with a larger mean measures gravity: it is not horizontal, or its unit is wrong.
LARGEST_MEAN_FORCE = 5.0  # m/s^2
#: No hub or tower top moves farther than this between two samples.
LARGEST_JUMP = 1000.0  # m
#: A larger range gets a note that asks whether the unit is right.
LARGEST_RANGE = 100.0  # m
#: A larger number, in SI units, is a wrong unit or damage: of a motion, and of a load (the base
#: moment of a large turbine comes near 1e9 N m).
LARGEST_VALUE, LARGEST_LOAD = 1e9, 1e12
FEWEST_SAMPLES = 32
#: Gaps up to this length are interpolated, and gaps up to two and a half sampling intervals. Fixes
#: and references may be missing for any time.
LONGEST_GAP = 0.1  # s
#: Rows may be this many steps apart.
WIDEST = 5.0
#: An IMU that samples less often is refused.
LOWEST_IMU_RATE = 5.0  # Hz


def require_possible(where: str, values: Array, hint: str, *, load: bool = False) -> None:
    """Raise `InputError` if a number, in SI units, is larger than that of any motion or load.

    `where` (file and column) begins the message, `hint` ends it.
    """
    most, kind = (LARGEST_LOAD, "load") if load else (LARGEST_VALUE, "motion")
    largest = float(np.max(np.abs(values), initial=0.0, where=~np.isnan(values)))
    require(
        largest <= most,
        f"{where} holds {largest:.3g} in SI units, and no {kind} reaches {most:g}: {hint}",
    )


def check_time(
    path: Path,
    name: str,
    time: Array,
    *,
    rows: NDArray[np.intp] | None = None,
    fewest: int = FEWEST_SAMPLES,
) -> None:
    """Check times in s, shape (n,), of the channel `name`; `rows` are their data rows, from 0.

    Raises InputError if there are fewer than `fewest`, one is missing, or they do not increase.
    """
    rows = np.arange(len(time)) if rows is None else rows
    require(len(time) >= fewest, f"{path}: has {len(time)} rows; at least {fewest} are needed")
    lost = ~np.isfinite(time)
    first = rows[lost.argmax()] + 1
    require(not lost.any(), f"{path}: time ({name}) is missing in data row {first}")
    step = np.diff(time)
    if step.min() <= 0.0:
        row = int(np.flatnonzero(step <= 0.0)[0])
        what = "goes backwards" if step[row] < 0.0 else "stands still"
        raise InputError(
            f"{path}: time ({name}) {what} in data row {rows[row + 1] + 1}: {time[row]:.9g} s, "
            f"then {time[row + 1]:.9g} s; sort the rows by time and drop repeated times"
        )


def find_gaps(
    time: Array, steps: float = 2.5, least: float | None = None
) -> list[tuple[float, float]]:
    """Return (start, end) in s of the long gaps between a channel's times.

    Longer, that is, than so many median intervals, and than `least` (None: `LONGEST_GAP`).
    """
    step = np.diff(time)
    longest = max(LONGEST_GAP if least is None else least, steps * float(np.median(step)))
    return [(float(time[k]), float(time[k + 1])) for k in np.flatnonzero(step > longest)]


def describe_gaps(gaps: Sequence[tuple[float, float]], shown: int = 3) -> str:
    """Return the first gaps in words, and the number of further ones."""
    text = ", ".join(f"{start:.6g} s to {end:.6g} s" for start, end in gaps[:shown])
    return text + (f" and {len(gaps) - shown} more" if len(gaps) > shown else "")


def describe_missing(name: str, values: Array) -> str:
    """Return where a channel, (n,), has no number; "" if each row has one."""
    rows = np.flatnonzero(np.isnan(values))
    more = f"({len(rows)} such rows in all)"
    return f"{name} has no number in data row {rows[0] + 1} {more}" if len(rows) else ""


def refuse_gaps(where: str, time: Array, least: float, hint: str = "") -> None:
    """Raise `InputError` if rising times (s) have gaps of more than `WIDEST` steps and `least`."""
    if wide := find_gaps(time, WIDEST + 0.5, least):
        longest = max(least, WIDEST * float(np.median(np.diff(time))))
        raise InputError(
            f"{where} has gaps longer than {longest:.3g} s: {describe_gaps(wide)}; cut the record "
            f"at the gaps{hint}"
        )


def check_extent(where: str, time: Array) -> None:
    """Raise `InputError` if a regular grid over rising times (s) has too many steps."""
    span, interval = time[-1] - time[0], np.median(np.diff(time))
    with np.errstate(over="ignore"):
        steps = float(span / interval) + 1.0
    require(
        steps <= MOST_STEPS,
        f"{where} spans {span:.3g} s at intervals of {interval:.3g} s: a regular grid would have "
        f"{steps:.3g} steps ({8e-9 * steps:.3g} GB per channel), and at most {MOST_STEPS} are "
        "allowed; does the time jump?",
    )


def check_channels(recording: Recording, gaps: str) -> list[str]:
    """Check every channel of a recording, and return notes for the user.

    `gaps` says whether long gaps in motion and specific force are refused ("refuse") or noted.

    Raises InputError for too few values, a slow IMU, a refused gap, or an impossible time or size.
    """
    notes: list[str] = []
    for role, values in recording.channels.items():
        name = f"{role} (channel {recording.names[role]})"
        where = f"{recording.path}: {name}"
        time, there = recording.series(role)
        require(len(there) > 0, f"{where} has no value at all")
        if role == "yaw":
            continue
        quantity = role.rsplit("_", 1)[0]
        sparse = quantity in ("fix", "reference")
        fewest = 2 if sparse else FEWEST_SAMPLES
        require(
            len(there) >= fewest, f"{where} has {len(there)} values; at least {fewest} are needed"
        )
        require_possible(where, there, f"check units.{role}, and mark missing values as NaN")
        if quantity != "fix":
            check_extent(where, time)
        if sparse:
            notes += _describe_holes(quantity, time)
        else:
            notes += _check_sampling(where, quantity, time, gaps)
            if missing := describe_missing(name, values):
                notes.append(f"{missing}: filled by cubic spline")
        notes += _check_size(where, name, role, time, there)
    return list(dict.fromkeys(notes))


def _describe_holes(quantity: str, time: Array) -> list[str]:
    if not (holes := find_gaps(time)):
        return []
    longest = max(end - start for start, end in holes)
    listed = describe_gaps(holes)
    return [f"{quantity}: {len(holes)} gap(s), the longest {longest:.3g} s, at {listed}"]


def _check_sampling(where: str, quantity: str, time: Array, gaps: str) -> list[str]:
    notes = []
    median = float(np.median(np.diff(time)))
    require(
        quantity != "specific_force" or 1.0 / median >= LOWEST_IMU_RATE,
        f"{where} comes at {1.0 / median:.3g} Hz; an IMU needs {LOWEST_IMU_RATE:g} Hz or more; if "
        "times are in milliseconds, set units.time=ms",
    )
    if gaps == "refuse":
        refuse_gaps(where, time, LONGEST_GAP, ", or use gaps=interpolate")
    if holes := find_gaps(time):
        notes.append(f"{quantity}: gaps interpolated: {describe_gaps(holes)}")
    comb = fit_comb(time)
    if not comb.uniform:
        notes.append(f"{quantity}: {describe_jitter(comb, median)}")
    elif comb.rounded:
        rounded = f"times rounded to {comb.resolution:g} s, taken as every {comb.step:.6g} s"
        notes.append(f"{quantity}: {rounded}")
    if quantity != "specific_force" and 1.0 / median < 2.0:
        lost = f"motion above {0.4 / median:.3g} Hz is not in it"
        notes.append(f"{quantity} comes at {1.0 / median:.3g} Hz: {lost}")
    return notes


def _check_size(where: str, name: str, role: str, time: Array, values: Array) -> list[str]:
    if role.startswith("specific_force"):
        mean = float(np.mean(values))
        require(
            abs(mean) <= LARGEST_MEAN_FORCE,
            f"{where} has the mean {mean:.4g} m/s^2, as if it measured gravity (9.81): it must be "
            f"a horizontal axis; check columns.{role} and units.{role}",
        )
    elif role.startswith(("position", "fix", "reference")):
        jump = np.abs(np.diff(values))
        row = int(np.argmax(jump))
        require(
            jump[row] <= LARGEST_JUMP,
            f"{where} jumps by {jump[row]:.4g} m at {time[row + 1]:.6g} s: check units.{role} and "
            "mark missing values as NaN",
        )
        extent = float(np.ptp(values))
        if extent > LARGEST_RANGE:
            return [f"{name} spans {extent:.4g} m: is its unit right (units.{role}=mm)?"]
    return []
