"""Resample recorded channels to the uniform grid on which the estimators run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.motion.recorded.checks import find_gaps
from owtsweep.motion.recorded.formats.table import MOST_STEPS
from owtsweep.motion.recorded.recording import Comb, Recording, fit_comb

#: The filter reaches zero at this multiple of the cut-off. A cut-off of 0.4 of a rate times 1.25 is
#: half the rate, its Nyquist frequency.
ROLL_OFF = 1.25
#: A channel is kept in full up to this multiple of its sampling rate.
FULL_BAND = 0.4


class BandLimited:
    """A band-limited function through n samples at the times start + k step, in s.

    It is kept in full up to `cutoff`, Hz, and not at all above `ROLL_OFF` times that. The
    evaluation is faster if the `rate` of its grids, Hz, is known.
    """

    def __init__(
        self, values: Array, start: float, step: float, cutoff: float, rate: float | None = None
    ) -> None:
        from scipy.fft import next_fast_len, rfft

        n = len(values)
        self.start = start
        self.offset = float(values[0])
        self.slope = float(values[-1] - values[0]) / ((n - 1) * step)
        pad = min(n - 1, max(int(np.ceil(20.0 / (cutoff * step))), n // 8))
        fade = np.cos(0.5 * np.pi * np.arange(1, pad + 1) / (pad + 1)) ** 2
        whole = 1 if rate is None else Fraction(rate * step).limit_denominator(1000).denominator
        total = whole * next_fast_len(-(-(n + 2 * pad) // whole), real=True)
        series = np.zeros(total)
        flat = series[:n]  # a view: each copy of ten million samples would take 80 MB
        flat[:] = np.arange(n)
        flat *= self.slope * step
        flat += self.offset
        np.subtract(values, flat, out=flat)
        series[n : n + pad] = -flat[n - 2 : n - 2 - pad if n - 2 - pad >= 0 else None : -1] * fade
        series[total - pad :] = (-flat[1 : pad + 1] * fade)[::-1]
        self.period = total * step
        last = min(int(np.floor(ROLL_OFF * cutoff * self.period)), (total - 1) // 2)
        lines = rfft(series, overwrite_x=True)[: last + 1] * (2.0 / total)
        lines[0] *= 0.5
        self.frequency: Array = np.arange(last + 1) / self.period
        # 1 up to the cut-off, then a raised cosine to 0 at `ROLL_OFF` times that
        edge = np.clip((self.frequency / cutoff - 1.0) / (ROLL_OFF - 1.0), 0.0, 1.0)
        self.lines: NDArray[np.complex128] = lines * (0.5 * (1.0 + np.cos(np.pi * edge)))

    def on_grid(self, start: float, rate: float, count: int, order: int = 0) -> Array:
        """Evaluate the function, or its first or second derivative, at the times start + k / rate.

        `order` is 0 for the function, 1 or 2 for a derivative. `start` is in s and `rate` in Hz.
        The result has shape (count,), k = 0, ..., count - 1.
        """
        first = start - self.start
        omega = 2.0 * np.pi * self.frequency
        terms = self.lines * (1j * omega) ** order * np.exp(1j * omega * first)
        points = self.period * rate
        values: Array
        if abs(points - round(points)) < 1e-5 and len(terms) <= round(points) // 2 >= 1:
            from scipy.fft import irfft

            terms[1:] *= 0.5
            terms *= round(points)
            values = irfft(terms, n=round(points))[:count]
        else:
            from scipy.signal import czt

            values = np.real(czt(terms, m=count, w=np.exp(2j * np.pi / points)))
        if order == 0:
            line = np.arange(count, dtype=float)
            line /= rate
            line += first
            line *= self.slope
            values += self.offset
            values += line
        elif order == 1:
            values += self.slope
        return values


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
    """A motion resampled to a grid."""

    grid: TimeGrid
    #: quantity -> values, shape (steps, 2), NaN in a reference's long gaps; an axis without a
    #: channel is zero.
    pairs: Mapping[str, Array]
    cutoff: float  # Hz, up to which the motion is kept
    notes: tuple[str, ...]


def find_common_grid(recording: Recording, roles: Sequence[str], rate: float) -> TimeGrid:
    """Return the grid of a rate in Hz over the time that all channels of the roles cover.

    Raises InputError if this is shorter than 1 s, or the grid would have more than `MOST_STEPS`
        steps.
    """
    spans = [recording.series(role)[0][[0, -1]] for role in roles]
    start = max(float(span[0]) for span in spans)
    length = min(float(span[1]) for span in spans) - start
    shared = f"{', '.join(roles)} share {max(length, 0.0):.3g} s of time"
    require(length >= 1.0, f"{recording.path}: {shared}; at least 1 s is needed")
    steps = length * rate
    require(
        steps <= MOST_STEPS,
        f"{recording.path}: {length:.4g} s at {rate:g} Hz are {steps:.3g} steps, "
        f"{160e-9 * steps:.3g} GB; at most {MOST_STEPS} are run: check units.time, cut the record "
        "into parts, or lower sensors.imu.rate",
    )
    return TimeGrid(start, rate, int(np.floor(steps + 1e-6)) + 1)


def to_grid(recording: Recording, role: str, grid: TimeGrid) -> Array:
    """Resample a channel of a checked recording to a grid, shape (steps,).

    Frequencies up to 0.4 of the lower rate (of channel and grid) are kept in full, those above half
    of it removed; samples on the grid are not changed. Irregular times and missing samples are
    first interpolated (`fill`).
    """
    values, comb, _ = make_uniform(recording, role)
    first = (grid.start - comb.start) / comb.step
    place = round(first)
    drift = abs(comb.step * grid.rate - 1.0) * grid.steps
    if abs(first - place) + drift <= 1e-3 and 0 <= place <= len(values) - grid.steps:
        return values[place : place + grid.steps]
    cutoff = FULL_BAND * min(1.0 / comb.step, grid.rate)
    function = BandLimited(values, comb.start, comb.step, cutoff, grid.rate)
    return function.on_grid(grid.start, grid.rate, grid.steps)


def make_uniform(recording: Recording, role: str) -> tuple[Array, Comb, list[tuple[float, float]]]:
    """Return a channel at the teeth of the comb of its times, (n,), gaps filled; comb and gaps."""
    time, values = recording.series(role)
    comb = fit_comb(time)
    if not (comb.uniform and comb.count == len(time)):
        values = fill(time, values, comb)
    return values, comb, find_gaps(time)


def fill(time: Array, values: Array, comb: Comb) -> Array:
    """Interpolate a channel, (n,), at the teeth of the comb of its times; return (comb.count,).

    The spline is cubic, in long gaps (`checks.find_gaps`) monotone. Samples on teeth are not
    changed.
    """
    from scipy.interpolate import CubicSpline, PchipInterpolator

    teeth = comb.teeth
    at = comb.start + comb.step * comb.number if comb.uniform else time
    filled = np.asarray(CubicSpline(at, values)(teeth))
    if holes := find_gaps(time):
        inside = mark_inside(teeth, holes)
        filled[inside] = PchipInterpolator(at, values)(teeth[inside])
    if comb.uniform:
        filled[comb.number.astype(np.int64)] = values
    return filled


def mark_inside(time: Array, holes: list[tuple[float, float]]) -> NDArray[np.bool_]:
    """Return which rising times, (n,) in s, are inside gaps, each (start, end) in s."""
    result = np.zeros(len(time), dtype=bool)
    for start, end in holes:
        result[np.searchsorted(time, start, "right") : np.searchsorted(time, end, "left")] = True
    return result
