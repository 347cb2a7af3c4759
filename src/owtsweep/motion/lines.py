"""Motion as a sum of lines, sampled with its derivatives and with what came before it.

Lines are at multiples of 1 / (twice the record), so that nothing repeats inside a record.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Resonances end at this multiple of their natural frequency.
HIGHEST = 3.0


class Series(NamedTuple):
    """Position and its two derivatives at samples, shape (samples, columns) each."""

    position: Array
    velocity: Array
    acceleration: Array


class Span(NamedTuple):
    """The samples of a record: their number, the interval in s, and how many come before it."""

    steps: int
    step: float
    lead: int = 0


def find_frequencies(steps: int, step: float) -> Array:
    """Return the frequencies of the lines in Hz, for a record of `steps` samples of `step` s."""
    return np.arange(steps + 1) / (2 * steps * step)


def respond(frequency: Array, period: float, damping: float) -> Array:
    """Return an oscillator's power response to white noise, up to a factor.

    It is zero at a frequency of 0 and above `HIGHEST` natural frequencies.
    """
    ratio = frequency * period
    response = 1.0 / ((1.0 - ratio**2) ** 2 + (2.0 * damping * ratio) ** 2)
    return np.where((ratio > 0.0) & (ratio <= HIGHEST), response, 0.0)


def scale_to_one(lines: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return lines (lines, columns) with a variance of 1 per column; without power they stay 0."""
    variance = 0.5 * np.sum(np.abs(lines) ** 2, axis=0)
    return np.asarray(lines / np.sqrt(np.where(variance > 0.0, variance, 1.0)))


def draw_lines(density: Array, generator: np.random.Generator) -> NDArray[np.complex128]:
    """Draw lines with a variance of 1, whose spectrum is `density` up to a factor, (lines, 1)."""
    real, imaginary = generator.standard_normal((2, len(density)))
    return scale_to_one((np.sqrt(density) * (real + 1j * imaginary))[:, None])


def sample(lines: NDArray[np.complex128], steps: int, step: float, lead: int) -> Series:
    """Sample lines and their exact derivatives every `step` s: `lead` times, then `steps` times.

    `lines` are complex amplitudes at `find_frequencies`, shape (steps + 1, columns); `lead` is at
    most `steps`.
    """
    rate = 2j * np.pi * find_frequencies(steps, step)[:, None]
    return Series(*(_sum_up(part, steps, lead) for part in (lines, rate * lines, rate**2 * lines)))


def _sum_up(lines: NDArray[np.complex128], steps: int, lead: int) -> Array:
    bins = lines * steps
    bins[-1] = 0.0
    return sample_periodic(bins, steps, lead)


def sample_periodic(bins: NDArray[np.complex128], steps: int, lead: int) -> Array:
    """Sample series that repeat after twice the record, and a lead, shape (lead + steps, ...).

    So what came before a record is known. `bins` are lines as `sample` has them, times `steps`: as
    `numpy.fft.irfft` takes them. The lead is at most `steps`.
    """
    period = np.fft.irfft(bins, 2 * steps, axis=0)
    return np.concatenate([period[2 * steps - lead :], period[:steps]])


def interpolate(series: Series, step: float, lead: int, times: Array) -> Array:
    """Return positions at times in s after the record's first sample, shape (n, columns).

    Between samples a polynomial of degree 5 has position, velocity and acceleration of both
    neighbours: the error is of the order of the sixth power of the step. Times before the lead get
    its first position.
    """
    x, v, a = series
    place = np.clip(np.asarray(times) / step + lead, 0.0, len(x) - 1.0)
    left = np.minimum(place.astype(int), len(x) - 2)
    s = (place - left)[:, None]
    right = left + 1
    gap, mean = x[right] - x[left], step * v[left]
    c2 = 0.5 * step**2 * a[left]
    rest = gap - mean - c2
    slope = step * v[right] - mean - 2.0 * c2
    bend = step**2 * a[right] - 2.0 * c2
    c3 = 10.0 * rest - 4.0 * slope + 0.5 * bend
    c4 = -15.0 * rest + 7.0 * slope - bend
    c5 = 6.0 * rest - 3.0 * slope + 0.5 * bend
    return np.asarray(x[left] + s * (mean + s * (c2 + s * (c3 + s * (c4 + s * c5)))))
