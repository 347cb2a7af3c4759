"""Find out how regular the times of a record are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

#: Times that deviate by less than this share of the interval count as regular.
TOLERANCE = 0.01


@dataclass(frozen=True)
class Comb:
    """Uniform times, called the teeth of a comb, fitted to the times of a record.

    Attributes
    ----------
    start, step
        The teeth are the times start + k step in s, fitted by least squares.
    count
        Number of teeth from the first time of the record to the last.
    number
        The number k of the tooth at each time of the record, shape (n,).
    jitter
        Largest distance between a time of the record and its tooth, s.
    resolution
        The decimal place to which the record's times are rounded, s, e.g. 0.001.
    uniform
        Whether all times of the record are teeth, apart from rounding. There may be teeth without a
        time.
    """

    start: float
    step: float
    count: int
    number: Array
    jitter: float
    resolution: float
    uniform: bool

    @property
    def rounded(self) -> bool:
        """Whether the record's times deviate from the teeth, but only because they are rounded."""
        return self.uniform and self.jitter > TOLERANCE * self.step

    @property
    def teeth(self) -> Array:
        """The times of all teeth in s, shape (count,)."""
        return self.start + self.step * np.arange(self.count)


def count_steps(time: Array) -> float:
    """Return how many steps a regular grid has that spans the given times at their median interval.

    `time` are increasing times in s, shape (n,). The result may be infinite.
    """
    with np.errstate(over="ignore"):
        return float((time[-1] - time[0]) / np.median(np.diff(time))) + 1.0


def fit_comb(time: Array) -> Comb:
    """Fit uniform times, the teeth of a comb, to the times of a record.

    `time` holds at least two times in s, strictly increasing. The record may have gaps. Times
    printed with few digits (80 Hz in whole milliseconds) count as uniform: a deviation of at most
    half the last decimal place is rounding, not jitter.
    """
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
    """Find the largest power of ten, from 1e-9 to 1 s, of which all times are multiples.

    Only the first 65 536 times (s) are looked at. If there is no such power of ten, 1e-9 is
    returned.
    """
    some = time[: 1 << 16]
    for place in range(10):
        scaled = some * 10.0**place
        slack = 1e-3 + 4e-16 * float(np.max(np.abs(scaled)))
        if np.max(np.abs(scaled - np.rint(scaled))) < slack:
            return 10.0**-place
    return 1e-9
