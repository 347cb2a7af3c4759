"""How regular the times of a record are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array

#: Deviations below this part of the interval do not make times irregular.
TOLERANCE = 0.01


@dataclass(frozen=True)
class Timing:
    """The uniform comb nearest to some times.

    Attributes
    ----------
    start, step
        The comb start + k step, s; fitted by least squares.
    count
        How many of its teeth it takes to reach the last time.
    number
        (n,) tooth of each time, a whole number.
    jitter
        Largest distance between a time and its tooth, s.
    resolution
        The decimal place that the times are rounded to, s.
    uniform
        Whether the teeth are the times, but for rounding and missing ones.
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
        """Whether the times deviate from the comb by their rounding alone."""
        return self.uniform and self.jitter > TOLERANCE * self.step

    @property
    def teeth(self) -> Array:
        """(count,) times of the comb, s."""
        return self.start + self.step * np.arange(self.count)


def timing(time: Array) -> Timing:
    """Fit a comb to strictly increasing times, (n,) s with n >= 2; missing teeth are allowed.

    Times printed with few digits (80 Hz in whole milliseconds) are uniform all the same: what
    deviates by no more than half their last decimal place is rounding, not jitter.
    """
    number = np.zeros(len(time))  # in place below: records may have ten million rows
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
    return Timing(start, step, int(number[-1]) + 1, number, jitter, resolution, uniform)


def _resolution(time: Array) -> float:
    """The largest power of ten, at most 1 s, that all times are multiples of; 1e-9 at least."""
    some = time[: 1 << 16]
    for place in range(10):
        scaled = some * 10.0**place
        slack = 1e-3 + 4e-16 * float(np.max(np.abs(scaled)))
        if np.max(np.abs(scaled - np.rint(scaled))) < slack:
            return 10.0**-place
    return 1e-9
