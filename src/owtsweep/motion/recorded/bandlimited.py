"""A band-limited function through uniform samples, and its exact derivatives at any times.

Method: the line between the two ends is taken off, the record is continued at both ends by its odd
reflection (value and slope run on) faded to zero, and the whole is one period of a Fourier series.
Lines up to the cut-off count in full, fall as a raised cosine to nothing at 1.25 times it, and are
multiplied by (j omega)^order; an inverse FFT evaluates the sum on the new grid, or a chirp
z-transform where the ratio of the rates is no fraction of small numbers. Position, velocity and
acceleration are so derivatives of one and the same function. Within some 2 / cut-off of the ends
the acceleration follows the reflection rather than the (unknown) continuation.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Where the filter reaches zero, over the cut-off; 0.4 of a rate times this is its Nyquist.
ROLL_OFF = 1.25


class BandLimited:
    """The function; `cutoff` in Hz, samples `values` (n,) at start + k step, s.

    `rate` is that of the grids it will be evaluated on, if known: Hz. It only makes that quicker.
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
        flat = series[:n]  # worked on in place: of ten million samples every copy is 80 MB
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
        self.lines: NDArray[np.complexfloating[Any, Any]] = lines * lowpass(self.frequency, cutoff)

    def on_grid(self, start: float, rate: float, count: int, order: int = 0) -> Array:
        """(count,) values of the derivative of that order at start + k / rate."""
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


def lowpass(frequency: Array, cutoff: float) -> Array:
    """1 up to the cut-off, a raised cosine from there to 0 at ROLL_OFF times it."""
    part = np.clip((frequency / cutoff - 1.0) / (ROLL_OFF - 1.0), 0.0, 1.0)
    return np.asarray(0.5 * (1.0 + np.cos(np.pi * part)))
