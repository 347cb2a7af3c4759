"""Resample recorded channels to the uniform grid on which the estimators run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.bandlimited import BandLimited
from owtsweep.motion.recorded.checks import find_gaps
from owtsweep.motion.recorded.formats.table import MOST_STEPS
from owtsweep.motion.recorded.recording import Recording
from owtsweep.motion.recorded.timing import Comb, fit_comb

#: A channel is kept in full up to this multiple of its sampling rate.
FULL_BAND = 0.4


@dataclass(frozen=True)
class TimeGrid:
    """The times start + k / rate for k = 0, ..., steps - 1; `start` is in s, `rate` in Hz."""

    start: float
    rate: float
    steps: int

    @property
    def time(self) -> Array:
        """The times of all steps on the file's clock, in s, shape (steps,)."""
        return self.start + np.arange(self.steps) / self.rate


@dataclass(frozen=True)
class Gridded:
    """Channels resampled to one grid.

    Attributes
    ----------
    grid
        The times of all values.
    channels
        role -> values in SI units, shape (steps,). GNSS fixes are NaN at steps without a fix, and
        references are NaN in long gaps. Other channels are never NaN.
    pairs
        quantity -> values of shape (steps, 2), columns x and y, which share memory with `channels`.
        An axis that was not requested is zero. GNSS fixes are not among the quantities.
    cutoff
        Frequency in Hz up to which the motion is kept; None if no motion was derived.
    notes
        What a user should know about the resampling, one sentence each.
    """

    grid: TimeGrid
    channels: Mapping[str, Array]
    pairs: Mapping[str, Array]
    cutoff: float | None
    notes: tuple[str, ...]


def find_common_grid(recording: Recording, roles: Sequence[str], rate: float) -> TimeGrid:
    """Return the grid over the time that all channels of the given roles cover.

    `rate` is the rate of the grid, Hz.

    Raises
    ------
    InputError
        If this time is shorter than 1 s, or the grid would have more than `MOST_STEPS` steps.
    """
    spans = [recording.series(role)[0][[0, -1]] for role in roles]
    start = max(float(span[0]) for span in spans)
    end = min(float(span[1]) for span in spans)
    if end - start < 1.0:
        raise InputError(
            f"{recording.path}: {', '.join(roles)} share {max(end - start, 0.0):.3g} s of time; "
            "at least 1 s is needed"
        )
    if not (end - start) * rate <= MOST_STEPS:
        raise InputError(
            f"{recording.path}: {end - start:.4g} s at {rate:g} Hz are {(end - start) * rate:.3g} "
            f"steps, {160e-9 * (end - start) * rate:.3g} GB; at most {MOST_STEPS} are run: check "
            "units.time, cut the record into parts, or lower sensors.imu.rate"
        )
    return TimeGrid(start, rate, int(np.floor((end - start) * rate + 1e-6)) + 1)


def to_grid(
    recording: Recording,
    roles: Sequence[str],
    rate: float,
    *,
    grid: TimeGrid | None = None,
) -> Gridded:
    """Resample channels to a grid.

    Each channel except GNSS fixes is resampled by a band-limited function (`bandlimited`). This
    function keeps frequencies up to 0.4 of the lower of two rates (of the channel and of the grid)
    in full. It removes all frequencies above half that rate, so that there are no images and no
    aliases. A channel whose samples already lie on the grid is not changed. Irregular times and
    missing samples are first interpolated by a cubic spline, long gaps (`checks.find_gaps`) by a
    monotone cubic spline. In its long gaps, a reference is NaN. GNSS fixes are not resampled: each
    fix moves to the nearest step, and of two fixes at one step the later one is kept.

    Parameters
    ----------
    recording
        A checked recording.
    roles
        The roles of the channels to resample, e.g. "position_x".
    rate
        Rate of the grid, Hz; not used if `grid` is given.
    grid
        The grid. By default it covers the time that the channels other than fixes and references
        have in common. If there are only fixes and references, it covers the time that these have
        in common.
    """
    if grid is None:
        dense = [role for role in roles if not role.startswith(("fix", "reference"))]
        grid = find_common_grid(recording, dense or roles, rate)
    channels: dict[str, Array] = {}
    pairs: dict[str, Array] = {}
    notes: list[str] = []
    for role in roles:
        if role.startswith("fix"):
            channels[role], said = _place_fixes(recording, role, grid)
            notes += said
            continue
        source, step, holes = make_uniform(recording, role)
        cutoff = FULL_BAND * min(1.0 / step, grid.rate)
        values = _take_if_on_grid(source, step, grid)
        if values is None:
            function = BandLimited(source[1], source[0], step, cutoff, grid.rate)
            values = function.on_grid(grid.start, grid.rate, grid.steps)
        channels[role] = make_column(pairs, role, grid)
        channels[role][:] = values
        if role.startswith("ref"):
            mark_gaps(channels[role], grid, holes)
    return Gridded(grid, channels, pairs, None, tuple(dict.fromkeys(notes)))


def make_column(pairs: dict[str, Array], role: str, grid: TimeGrid) -> Array:
    """Make an array of shape (steps,) for a role, filled with zeros.

    For a role with an axis, e.g. "position_x", the array is a column of the array
    `pairs["position"]`. The latter has shape (steps, 2), and is added to `pairs` if missing. A role
    without an axis, e.g. "yaw", gets an array of its own.
    """
    quantity, _, axis = role.rpartition("_")
    if axis not in ("x", "y"):
        return np.zeros(grid.steps)
    return pairs.setdefault(quantity, np.zeros((grid.steps, 2)))[:, "xy".index(axis)]


def make_uniform(
    recording: Recording, role: str
) -> tuple[tuple[float, Array], float, list[tuple[float, float]]]:
    """Return a channel as uniform samples: ((start, samples), step, gaps).

    `start` is the time of the first sample and `step` the sampling interval, in s. Missing samples
    are interpolated. The gaps, each (start, end) in s, are those of `checks.find_gaps`.
    """
    time, values = recording.series(role)
    comb, holes = fit_comb(time), find_gaps(time)
    if comb.uniform and comb.count == len(time):
        return (comb.start, values), comb.step, holes
    return (comb.start, fill(time, values, comb)), comb.step, holes


def fill(time: Array, values: Array, comb: Comb) -> Array:
    """Interpolate at the teeth of a comb; return values of shape (comb.count,).

    `time` (s) and `values`, shape (n,), are a channel without missing samples, and `comb` is fitted
    to its times. Samples that lie on teeth are not changed.
    """
    from scipy.interpolate import CubicSpline, PchipInterpolator

    teeth = comb.teeth
    at = comb.start + comb.step * comb.number if comb.uniform else time
    filled = np.asarray(CubicSpline(at, values)(teeth))
    if holes := find_gaps(time):
        inside = _mark_inside(teeth, holes)
        filled[inside] = PchipInterpolator(at, values)(teeth[inside])
    if comb.uniform:
        filled[comb.number.astype(np.int64)] = values
    return filled


def _take_if_on_grid(source: tuple[float, Array], step: float, grid: TimeGrid) -> Array | None:
    """Return a channel's samples at the times of a grid; None unless all have a sample.

    `source` is (start, samples): the samples are at the times start + k step, in s. A sample may be
    off the grid's time by 1e-3 of `step`.
    """
    start, values = source
    first = (grid.start - start) / step
    drift = abs(step * grid.rate - 1.0) * grid.steps
    place = round(first)
    if abs(first - place) + drift > 1e-3 or place < 0 or place + grid.steps > len(values):
        return None
    return values[place : place + grid.steps]


def _mark_inside(time: Array, holes: list[tuple[float, float]]) -> NDArray[np.bool_]:
    """Return a mask of the times (increasing, s) that lie strictly inside a gap.

    `holes` holds the gaps, each (start, end) in s.
    """
    result = np.zeros(len(time), dtype=bool)
    for start, end in holes:
        result[np.searchsorted(time, start, "right") : np.searchsorted(time, end, "left")] = True
    return result


def mark_gaps(values: Array, grid: TimeGrid, holes: list[tuple[float, float]]) -> None:
    """Set the values inside gaps to NaN, in place.

    `values` belong to the times of `grid`, shape (steps,). `holes` holds the gaps, each (start,
    end) in s.
    """
    if holes:
        values[_mark_inside(grid.time, holes)] = np.nan


def _place_fixes(recording: Recording, role: str, grid: TimeGrid) -> tuple[Array, list[str]]:
    """Move GNSS fixes to the nearest steps of a grid; return (values, notes).

    The values have shape (steps,) and are NaN at steps without a fix. If two fixes move to one
    step, the later fix is kept. The notes say how far fixes moved, and how many were dropped.
    """
    time, values = recording.series(role)
    exact = (time - grid.start) * grid.rate
    place = np.rint(exact).astype(np.int64)
    kept = (place >= 0) & (place < grid.steps)
    result = np.full(grid.steps, np.nan)
    result[place[kept]] = values[kept]
    moved = float(np.max(np.abs(exact - place)[kept], initial=0.0)) / grid.rate
    notes = []
    if moved > 1e-6:
        notes.append(f"fixes moved to the nearest step, by {moved:.3g} s at most")
    lost = int(kept.sum()) - len(np.unique(place[kept]))
    if lost:
        notes.append(f"{role}: {lost} fixes dropped: a later fix fell on the same IMU step")
    return result, notes
