"""Fit a band-limited function to uniform samples, and evaluate its derivatives at other times.

The straight line between the two ends is subtracted, and the record is continued at both ends by
its odd reflection, faded to zero, so that value and slope are continuous: one period of a Fourier
series. Its lines are kept up to the cut-off, and weighted by a raised cosine beyond. For a
derivative they are multiplied by (j omega)^order. They are summed on the new grid by an inverse
FFT, or by a chirp z-transform if the ratio of old and new rate is not a fraction of small numbers.

Within a time of about 2 / cut-off from either end of the record, the acceleration depends on the
reflection, because the real continuation of the record is unknown.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: The filter reaches zero at this multiple of the cut-off. A cut-off of 0.4 of a rate times 1.25 is
#: half the rate, its Nyquist frequency.
ROLL_OFF = 1.25


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
        self.lines: NDArray[np.complex128] = lines * lowpass(self.frequency, cutoff)

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


def lowpass(frequency: Array, cutoff: float) -> Array:
    """Return the gain: 1 up to `cutoff` (Hz), then a raised cosine to 0 at `ROLL_OFF` * cutoff."""
    part = np.clip((frequency / cutoff - 1.0) / (ROLL_OFF - 1.0), 0.0, 1.0)
    return np.asarray(0.5 * (1.0 + np.cos(np.pi * part)))
