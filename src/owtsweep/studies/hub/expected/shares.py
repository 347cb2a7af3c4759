"""Computes the expectation over the records of a spectrum from a curve over frequency.

A record is a sum of sinusoids (lines) of fixed amplitudes and independent random phases, so the
expectation of its squared error is the sum over its lines. Normalised to a standard deviation of 1
m, the record's error is a ratio of two sums that vary together: in a finite record neighbouring
lines beat.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import Spectrum
from owtsweep.motion.synthesis import lines


@dataclass(frozen=True)
class Lines:
    """The spectral lines of records of one length.

    Attributes
    ----------
    frequency
        (n,) Hz, evenly spaced.
    beat
        Fourier transform of the mean square beat of two lines over the record, as a function of the
        difference of their numbers.
    size
        Length of that transform.
    """

    frequency: Array
    beat: Array
    size: int


def lines_of(band: tuple[float, float], duration: float) -> Lines:
    """The lines inside the band.

    The record is half as long as the common period of its lines. So the beat of two lines m and n
    has the mean sin(pi (m - n) / 2) / (pi (m - n) / 2) over the record.
    """
    from scipy.fft import next_fast_len, rfft

    _, frequency = lines(band, 2.0 * duration)
    count = len(frequency)
    size = next_fast_len(2 * count, real=True)
    apart = np.arange(size)
    apart = np.where(apart < count, apart, np.where(apart > size - count, size - apart, 0))
    beat = np.sinc(0.5 * apart) ** 2
    beat[0] = 0.0  # a line does not beat with itself
    beat[count : size - count + 1] = 0.0
    return Lines(frequency, rfft(beat).real, size)


def expected_ratio(spectrum: Spectrum, curves: Array, drawn: Lines) -> Array:
    """Expected mean square error of records of standard deviation 1 m, (...).

    E[n / d] = E n / E d (1 + var d / (E d)^2 - cov(n, d) / (E n E d)), accurate to second order in
    the records' scatter (0.6 % for the default records, more for narrower spectra and shorter
    records). The beats of the error are approximated by those of the motion times the geometric
    mean of the curve at both lines.

    Parameters
    ----------
    curves
        (..., n) at the lines.
    """
    from scipy.fft import rfft

    share = spectrum.density(drawn.frequency)
    share = share / np.sum(share)
    mean = np.sum(share * curves, axis=-1)
    flat = curves.reshape(-1, len(share))
    shapes = np.concatenate([np.ones((1, len(share))), flat]) ** 0.5 * share
    transformed = np.abs(rfft(shapes, n=drawn.size, axis=-1)) ** 2 * drawn.beat
    # Parseval for real sequences: all terms count twice except the first and, for an even length,
    # the last
    twice = np.full(transformed.shape[-1], 2.0)
    twice[0] = 1.0
    if drawn.size % 2 == 0:
        twice[-1] = 1.0
    beats = np.sum(transformed * twice, axis=-1) / drawn.size
    relative = beats[1:].reshape(mean.shape) / mean
    return np.asarray(mean * (1.0 + beats[0] - relative))
