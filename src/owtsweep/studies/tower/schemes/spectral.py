"""Split, differentiate and integrate records in the frequency domain, without phase."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

from owtsweep.arrays import Array

#: Order of the filters; a low-pass has the gain of a Butterworth filter run there and back.
ORDER = 4
#: Time for which a record is continued beyond its ends, in periods of the lowest split frequency.
MARGIN = 10.0


class Bands:
    """Bands between split frequencies, with gains that sum to 1, for records of one length.

    Records are continued beyond both ends by their reflection in the end point, so that they
    neither jump there nor wrap around.

    Parameters
    ----------
    steps
        Number of samples of a record, 2 or more.
    step
        Sampling interval, s.
    splits
        Frequencies in Hz at which bands meet, upwards.
    """

    def __init__(self, steps: int, step: float, splits: Sequence[float]) -> None:
        self.steps = steps
        self.margin = min(steps - 1, round(MARGIN / (splits[0] * step)))
        self.size = next_fast_len(steps + 2 * self.margin, real=True)
        frequency = rfftfreq(self.size, step)
        below = [1.0 / (1.0 + (frequency / split) ** (2 * ORDER)) for split in splits]
        #: Gain of each band, upwards, shape (splits + 1, frequencies).
        self.gains = np.diff(np.array([0.0 * frequency, *below, 1.0 + 0.0 * frequency]), axis=0)
        self.rate = 2j * np.pi * frequency

    def differentiate(self, signal: Array, band: int) -> tuple[Array, Array, Array]:
        """Return signals (steps, signals) in a band, their first and their second derivative."""
        inside = self._transform(signal, band)
        rate = self.rate[:, None]
        return self._back(inside), self._back(inside * rate), self._back(inside * rate**2)

    def integrate(self, acceleration: Array, band: int) -> tuple[Array, Array, Array]:
        """Return displacement, velocity and acceleration in a band other than the lowest."""
        inside = self._transform(acceleration, band)
        inverse = np.zeros_like(self.rate)
        inverse[1:] = 1.0 / self.rate[1:]
        once = inside * inverse[:, None]
        return self._back(once * inverse[:, None]), self._back(once), self._back(inside)

    def _transform(self, signal: Array, band: int) -> Array:
        first, last = signal[:1], signal[-1:]
        before = 2.0 * first - signal[self.margin : 0 : -1]
        after = 2.0 * last - signal[-2 : -self.margin - 2 : -1]
        padded = np.concatenate([before, signal, after])
        # The rest of the transform's length leads from the last value back to the first.
        rest = np.linspace(padded[-1], padded[0], self.size - len(padded) + 2)[1:-1]
        spectrum = rfft(np.concatenate([padded, rest]), axis=0)
        return np.asarray(spectrum * self.gains[band][:, None])

    def _back(self, spectrum: Array) -> Array:
        whole = irfft(spectrum, self.size, axis=0)
        return np.ascontiguousarray(whole[self.margin : self.margin + self.steps])
