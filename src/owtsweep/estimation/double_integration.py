"""Displacements of a structure from its accelerations: the chain of Maes et al. (2018), Fig. 8.

Accelerations at 200 Hz are decimated to 20 Hz, integrated twice in the frequency domain and passed
through a high-pass filter, for below its edge the noise of accelerations has grown to more than the
motion. What moves slower than 0.15 Hz, such as a load swinging on its hook, is lost by design.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require

#: Rate after decimation, Hz. The edge of the filter before it is .4 of this, 8 Hz.
RATE = 20.0
#: Order of the filter before decimation.
DECIMATION_ORDER = 8
#: Order, edge in Hz and ripple in dB of the high-pass filter.
ORDER, EDGE, RIPPLE = 5, 0.15, 0.01
#: Length, s, by which both ends are continued before the high-pass filter runs in both directions:
#: its slowest part decays by e in 6.6 s. The first and last 20 s are still less exact.
PADDING = 10.0


def decimate(signal: Array, rate: float) -> Array:
    """Return a signal at 20 Hz, shape (new samples,) or (new samples, axes).

    The filter before it is the paper's: Chebyshev of type I, order 8, edge at 8 Hz, run forward and
    in reverse, so that nothing is delayed. Its ripple of .05 dB is that of `scipy.signal.decimate`
    and, because the order is even, a loss at 0 Hz: both runs together take up to 1.1 % of motions.

    rate: sampling rate, Hz, a whole multiple of 20 Hz. At 20 Hz, a copy is returned.
    Raises InputError if the signal is too short.
    """
    from scipy.signal import decimate

    factor = round(rate / RATE)
    if factor == 1:
        return signal.copy()
    try:
        return np.asarray(
            decimate(signal, factor, n=DECIMATION_ORDER, ftype="iir", axis=0, zero_phase=True)
        )
    except ValueError as error:  # the padding at both ends is longer than the signal
        raise InputError(f"signal: {len(signal)} samples are too few; some seconds work") from error


def integrate_twice(acceleration: Array, rate: float) -> Array:
    """Return displacements with mean 0, in the unit of the acceleration times s^2, same shape.

    The Fourier transform is divided by -omega^2. In print, the minus is missing; without it, the
    displacement has the opposite sign. The mean of the acceleration, a bias, is removed. The
    transform takes the record as periodic. If it is not, the result differs from the motion by a
    parabola over the record, which `pass_high` removes away from both ends.

    acceleration: shape (samples,) or (samples, axes).
    rate: sampling rate, Hz.
    """
    samples = len(acceleration)
    omega = 2.0 * np.pi * np.fft.rfftfreq(samples, 1.0 / rate)
    divided = np.zeros_like(omega)
    divided[1:] = -1.0 / omega[1:] ** 2
    spectrum = np.fft.rfft(acceleration, axis=0)
    return np.asarray(np.fft.irfft((spectrum.T * divided).T, n=samples, axis=0))


def pass_high(signal: Array, rate: float, *, zero_phase: bool = True) -> Array:
    """Return a signal, shape (samples,) or (samples, axes), without what is slower than 0.15 Hz.

    The filter is Chebyshev of type I, order 5, with a ripple of .01 dB. The paper does not say
    whether it runs forward only. If it does, what passes leads, by 83 degrees at .3 Hz and 24 at
    1 Hz: an error of 1.33 and .42 times its size.

    rate: sampling rate, Hz.
    zero_phase: whether to run the filter in reverse too. If not, it runs as if the first value had
        stood for ever before.
    Raises InputError if a signal for both directions is not longer than 10 s.
    """
    from scipy.signal import cheby1, sosfilt, sosfilt_zi, sosfiltfilt

    sections = cheby1(ORDER, RIPPLE, EDGE, btype="highpass", output="sos", fs=rate)
    if not zero_phase:
        # From rest, the first value, metres after `integrate_twice`, would ring for 20 s.
        start = np.multiply.outer(sosfilt_zi(sections), signal[0])
        return np.asarray(sosfilt(sections, signal, axis=0, zi=start)[0])
    padding = round(PADDING * rate)
    require(
        len(signal) > padding,
        f"signal: lasts {len(signal) / rate:.3g} s; more than {PADDING:g} s would work, or "
        "zero_phase=False",
    )
    return np.asarray(sosfiltfilt(sections, signal, axis=0, padlen=padding))
