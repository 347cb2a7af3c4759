"""Sums of few lines at many samples: inverse Fourier transforms most of whose bins are zero."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array

#: A short transform has at least so many samples per number of the last line. With more the
#: transforms are longer; with fewer there are more factors to multiply the lines with.
SHORT = 8
#: A short transform has at least so many samples: to call a shorter one takes longer than to do it.
LEAST = 1024
#: Transforms that one call makes side by side: SIDE_BY_SIDE, but at most a quarter of all, which
#: limits the memory that they need; or as many short ones as have TOGETHER samples.
SIDE_BY_SIDE, TOGETHER = 4, 2**16
#: Longer transforms are made by NumPy: where a length has large prime factors, SciPy keeps some
#: hundred bytes per sample as long as the process lives.
LONG = 2**19


def interleaved(bins: NDArray[np.complex128], samples: int) -> Array:
    """Re sum_m bins[m] exp(2 pi i m n / samples) for all samples n, some rows of them.

    Sorensen and Burrus (1993), "Efficient computation of the DFT with only a subset of input or
    output points", IEEE Trans. Signal Process. 41(3), for few inputs: the samples n = r, r + L,
    r + 2 L, ... are a transform of samples / L of the bins times exp(2 pi i m r / samples). These
    L short ones fit the caches, go through the processor side by side, and have few zeros to add.

    Parameters
    ----------
    bins
        (last + 1,), the first of them zero, 2 last < samples.
    samples
        How many, an even number.

    Returns
    -------
    (L, samples / L), of which the second is even; sample L j + r stands in row r, column j.
    """
    from scipy.fft import irfft

    length = _short_length(len(bins) - 1, samples)
    turns = _turns(len(bins), samples, length)
    transform: Any = irfft if length <= LONG else np.fft.irfft
    rows = np.empty((len(turns), length))
    count = max(min(len(turns) // 4, SIDE_BY_SIDE), TOGETHER // length, 1)
    # padded once here; else the transform would copy them into longer arrays at each call
    padded = np.zeros((min(count, len(turns)), length // 2 + 1), dtype=complex)
    for first in range(0, len(turns), count):
        some_turns = turns[first : first + count]
        some = padded[: len(some_turns)]
        np.multiply(bins, some_turns, out=some[:, : len(bins)])
        rows[first : first + count] = transform(some, n=length, axis=1)
    return rows


@lru_cache
def _short_length(last: int, samples: int) -> int:
    """The length of the short transforms: an even divisor of `samples`."""
    for count in range(samples // max(SHORT * last, LEAST), 1, -1):
        if samples % (2 * count) == 0:
            return samples // count
    return samples


@lru_cache(maxsize=2)
def _turns(bins: int, samples: int, length: int) -> NDArray[np.complex128]:
    """(samples / length, bins): what turns each bin to the first sample of each row."""
    numbers, first = np.arange(bins), np.arange(samples // length)
    # the product modulo a whole turn, exactly: a large angle has lost its last digits
    angle = 2.0 * np.pi / samples * (first[:, None] * numbers % samples)
    # irfft divides by its length, and a cosine is half of a pair
    turns: NDArray[Any] = np.exp(1j * angle) * (length / 2)
    turns.setflags(write=False)
    return turns
