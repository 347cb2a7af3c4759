"""The series read from a file, and how regular their times are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array

#: Times that deviate by less than this share of the interval count as regular.
TOLERANCE = 0.01


@dataclass(frozen=True)
class Recording:
    """The contents of one file, in SI units, at the file's times."""

    path: Path
    time: Array  # s, strictly increasing, shape (n,)
    channels: dict[str, Array]  # role -> values, shape (n,), NaN where missing
    names: Mapping[str, str]  # role, or "time" -> the channel's name
    notes: tuple[str, ...]
    #: Axis -> the channel of the platform's angle that leans it along this axis, and the angle in
    #: rad, shape (n,), or None if its unit is not known. Empty beside a specific force, which holds
    #: the lean already.
    leans: Mapping[str, tuple[str, Array | None]] = field(default_factory=dict)

    def has(self, quantity: str) -> bool:
        """Return whether there is at least one axis of a quantity such as "fix"."""
        return any(f"{quantity}_{axis}" in self.channels for axis in "xy")

    def let_go(self, quantity: str) -> None:
        """Delete both axes of a quantity that is no longer needed, to free memory."""
        for axis in "xy":
            self.channels.pop(f"{quantity}_{axis}", None)

    def series(self, role: str) -> tuple[Array, Array]:
        """Return the times (s) and values of a role without missing samples, shape (m,) each."""
        values = self.channels[role]
        there = np.isfinite(values)
        if there.all():  # saves copies of a long record
            return self.time, values
        return self.time[there], values[there]

    def rate(self, role: str) -> float:
        """Return 1 over the median interval between the values of a role's channel, Hz."""
        time, _ = self.series(role)
        return float(1.0 / np.median(np.diff(time)))


@dataclass(frozen=True)
class Comb:
    """Uniform times, called the teeth of a comb, fitted to the times of a record.

    There may be teeth without a time.
    """

    start: float  # the teeth are start + k step, s
    step: float
    count: int  # of the teeth from the record's first time to its last
    number: Array  # (n,), the k of each time
    jitter: float  # largest distance between a time and its tooth, s
    resolution: float  # the decimal place to which times are rounded, s, e.g. 0.001
    uniform: bool  # whether all times are teeth, apart from rounding

    @property
    def rounded(self) -> bool:
        """Whether the times deviate from the teeth, but only because they are rounded."""
        return self.uniform and self.jitter > TOLERANCE * self.step

    @property
    def teeth(self) -> Array:
        """The times of all teeth in s, shape (count,)."""
        return self.start + self.step * np.arange(self.count)


def fit_comb(time: Array, number: Array | None = None) -> Comb:
    """Fit a comb by least squares to at least two increasing times in s, shape (n,).

    The record may have gaps, unless `number` has the teeth. Times printed with few digits (80 Hz in
    whole milliseconds) count as uniform: half the last decimal place is rounding, not jitter.
    """
    if number is None:
        number = np.zeros(len(time))  # filled in place: a record may have ten million rows
        interval = np.diff(time)
        interval /= np.median(interval)
        np.maximum(np.rint(interval, out=interval), 1.0, out=interval)
        np.cumsum(interval, out=number[1:])
        del interval
    centred = number - number.mean()
    step = float(centred @ (time - time.mean()) / (centred @ centred))
    start = float(time.mean() - step * number.mean())
    deviation = np.multiply(number, -step, out=centred)
    deviation += time
    deviation -= start
    jitter = float(max(deviation.max(), -deviation.min()))
    resolution = _resolution(time)
    uniform = jitter <= max(TOLERANCE * step, min(0.51 * resolution, 0.3 * step))
    return Comb(start, step, int(number[-1]) + 1, number, jitter, resolution, uniform)


def describe_jitter(comb: Comb, median: float) -> str:
    """Say how far times are off the teeth of a comb; `median` is their median interval, s."""
    return (
        f"irregular times, median interval {median:.6g} s, at most {comb.jitter:.3g} s "
        f"({100 * comb.jitter / comb.step:.2g} % of it) off a regular grid: resampled by cubic "
        "spline"
    )


def _resolution(time: Array) -> float:
    """Find the largest power of ten, 1e-9 to 1 s, of which the first times are multiples."""
    some = time[: 1 << 16]
    for place in range(10):
        scaled = some * 10.0**place
        slack = 1e-3 + 4e-16 * float(np.max(np.abs(scaled)))
        if np.max(np.abs(scaled - np.rint(scaled))) < slack:
            return 10.0**-place
    return 1e-9
