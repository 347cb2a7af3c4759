"""Computes inverse Fourier transforms of few spectral lines to many samples.

Most bins of such a transform are zero, and little time is spent on these bins.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: Least length of a short transform divided by the number of the last line. A larger value makes
#: the transforms longer; a smaller one needs more factors to multiply the lines with.
SHORT = 8
#: Least length of a short transform, samples: for a shorter one the call takes most of the time.
LEAST = 1024
#: Number of transforms in one call: SIDE_BY_SIDE, but at most a quarter of all, to limit memory. If
#: transforms are short, more are made in one call, with TOGETHER samples in total.
SIDE_BY_SIDE, TOGETHER = 4, 2**16
#: Longer transforms are made by NumPy: for a length with large prime factors, SciPy keeps some
#: hundred bytes per sample until the process ends.
LONG = 2**19


def interleaved(bins: NDArray[np.complex128], samples: int) -> Array:
    """Compute Re sum_m bins[m] exp(2 pi i m n / samples) for n = 0, ..., samples - 1.

    One long Fourier transform is split into L short ones. The samples n = r, r + L, r + 2 L, ...
    are a transform of length samples / L of bins[m] exp(2 pi i m r / samples). Short transforms fit
    into the processor's caches, run side by side, and need few zeros as padding. Source: Sorensen
    and Burrus (1993), "Efficient computation of the DFT with only a subset of input or output
    points", IEEE Trans. Signal Process. 41(3).

    Parameters
    ----------
    bins
        Complex amplitudes, shape (last + 1,), with bins[0] = 0 and 2 last < samples.
    samples
        Number of samples, even.

    Returns
    -------
    array
        Shape (L, samples / L), where samples / L is even. Sample L j + r is in row r, column j.
    """
    from scipy.fft import irfft

    length = _short_length(len(bins) - 1, samples)
    turns = _turns(len(bins), samples, length)
    transform = irfft if length <= LONG else np.fft.irfft
    rows = np.empty((len(turns), length))
    count = max(min(len(turns) // 4, SIDE_BY_SIDE), TOGETHER // length, 1)
    # padded once here; otherwise each transform would copy them into longer arrays
    padded = np.zeros((min(count, len(turns)), length // 2 + 1), dtype=complex)
    for first in range(0, len(turns), count):
        some_turns = turns[first : first + count]
        some = padded[: len(some_turns)]
        np.multiply(bins, some_turns, out=some[:, : len(bins)])
        rows[first : first + count] = transform(some, n=length, axis=1)
    return rows


@lru_cache
def _short_length(last: int, samples: int) -> int:
    """Choose the length of the short transforms into which a long transform is split.

    The long transform has `samples` samples. The length is the least even divisor of `samples` that
    is at least `LEAST` and at least `SHORT` times `last`, the number of the last spectral line.
    Without such a divisor, the length is `samples`.
    """
    for count in range(samples // max(SHORT * last, LEAST), 1, -1):
        if samples % (2 * count) == 0:
            return samples // count
    return samples


@lru_cache(maxsize=2)
def _turns(bins: int, samples: int, length: int) -> NDArray[np.complex128]:
    """Compute the factor of each bin in each short transform, shape (samples / length, bins).

    A transform of `samples` samples is split into short ones of the length `length`. The factor for
    bin m and short transform r is exp(2 pi i m r / samples) times length / 2. `bins` is the number
    of bins.
    """
    numbers, first = np.arange(bins), np.arange(samples // length)
    # the exact product modulo a whole turn: a large angle would lose its last digits
    angle = 2.0 * np.pi / samples * (first[:, None] * numbers % samples)
    # irfft divides by its length, and a cosine is half of a pair
    turns: NDArray[np.complex128] = np.exp(1j * angle) * (length / 2)
    turns.setflags(write=False)
    return turns
