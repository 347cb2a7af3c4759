"""Criteria of how well one signal follows another: TRAC, FRAC, errors, and lag.

Equation numbers are those of Simpson, Chatzi and Chatzis (2025), section 5.2. Each function takes
the true signals and their estimates, two arrays of one shape, (steps,) or (steps, channels), and
returns one value per channel: an array of shape () or (channels,).
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require

#: Longest lag that is looked for, s, and as a part of the record.
LONGEST, PART = 5.0, 0.2


def compute_trac(truth: Array, estimate: Array, *, centred: bool = False) -> Array:
    """Compute the time response assurance criterion (Eq. 27), from 0 to 1.

    The criterion is blind to the scale and the sign of the estimate. As printed, means count, so
    that it is near 1 for any two signals with means far above their standard deviations; `centred`
    takes them off first, and gives the square of the correlation coefficient. NaN for a channel
    that is zero throughout (with `centred`: constant).
    """
    if centred:
        truth, estimate = _centre(truth), _centre(estimate)
    return _compare(truth, estimate, np.ones(len(truth)))


def compute_frac(truth: Array, estimate: Array) -> Array:
    """Compute the frequency response assurance criterion (Eq. 28) of magnitudes, from 0 to 1.

    With complex spectra Eq. (28) would be Eq. (27) again, by Parseval's theorem. What is printed in
    the paper differs from TRAC, so this function takes the magnitudes of the spectra, over positive
    and negative frequencies. Phases do not matter then, and FRAC is never below TRAC. NaN is as in
    `compute_trac`.
    """
    steps = len(truth)
    true_size, size = (np.abs(np.fft.rfft(signal, axis=0)) for signal in (truth, estimate))
    weights = np.full(len(size), 2.0)  # a positive frequency and its negative
    weights[0] = 1.0
    if steps % 2 == 0:
        weights[-1] = 1.0
    return _compare(true_size, size, weights)


def compute_mae(truth: Array, estimate: Array) -> Array:
    """Compute the mean absolute error (Eq. 29), in the signals' unit."""
    return np.asarray(np.abs(estimate - truth).mean(axis=0))


def compute_rms_error(truth: Array, estimate: Array) -> Array:
    """Compute the root mean square of the error, mean included, in the signals' unit."""
    return np.asarray(np.sqrt(np.square(estimate - truth).mean(axis=0)))


def divide_by_deviation(error: Array, truth: Array) -> Array:
    """Divide an error, e.g. of `compute_mae`, by the true signal's standard deviation.

    NaN for a channel whose true signal is constant.
    """
    deviation = np.sqrt(np.square(_centre(truth)).mean(axis=0))
    return divide(np.asarray(error), deviation)


def scatter(truth: Array, estimate: Array) -> Array:
    """Return the standard deviation of the error over that of the truth, of each column.

    The mean error does not count: in the field the zero of an inclinometer is not known, and
    fatigue needs the changes. A drift counts. (`compute_mae` keeps the mean.)
    """
    return divide_by_deviation(np.std(estimate - truth, axis=0), truth)


def find_lag(
    truth: Array,
    estimate: Array,
    step: float,
    longest: float | None = None,
    *,
    nearest: bool = False,
) -> Array:
    """Find by how much an estimate comes late, in s; negative if it runs ahead of the truth.

    The lag is where the correlation coefficient of the truth and the shifted estimate, over the
    samples that both have, is largest; a parabola through three coefficients finds parts of a
    sampling interval `step` (s). Means are taken off first. The true lag of a signal with one
    period is known but for whole periods; make `longest` (s) shorter than half a period then; None
    is 5 s, or a fifth of the record if that is less, but a sampling interval at least. A result of
    +-`longest` means that the lag is that long or longer; NaN means a constant signal.
    With `nearest`, the lag is at the first maximum on the way from no lag. Raise `InputError` if
    `longest` is shorter than a sampling interval, or not below half the record.
    """
    steps = len(truth)
    longest = max(step, min(LONGEST, PART * steps * step)) if longest is None else longest
    most = round(longest / step)
    require(
        1 <= most < steps / 2,
        f"longest: {longest:g} s must be from one sampling interval ({step:g} s) to less than half "
        f"the record ({steps * step / 2:g} s)",
    )
    shape = truth.shape[1:]
    pairs = zip(truth.reshape(steps, -1).T, estimate.reshape(steps, -1).T, strict=True)
    lags = [
        step * _find_shift(_centre(true), _centre(guess), most, nearest) for true, guess in pairs
    ]
    return np.array(lags).reshape(shape)


def _find_shift(truth: Array, estimate: Array, most: int, nearest: bool) -> float:
    """Return the shift, in samples, at which two signals without means correlate best."""
    if not (truth.any() and estimate.any()):
        return float("nan")
    steps = len(truth)
    size = 2 ** int(np.ceil(np.log2(steps + most)))  # no overlap of both ends within the shifts
    spectrum = np.conj(np.fft.rfft(truth, size)) * np.fft.rfft(estimate, size)
    shifts = np.arange(-most, most + 1)
    products = np.fft.irfft(spectrum, size)[shifts]  # sum over t of truth[t] estimate[t + shift]
    # Energies of the samples that overlap at each shift, from running sums.
    powers = [np.concatenate([[0.0], np.cumsum(np.square(x))]) for x in (truth, estimate)]
    late, early = np.maximum(shifts, 0), np.maximum(-shifts, 0)
    true_power = powers[0][steps - late] - powers[0][early]
    estimate_power = powers[1][steps - early] - powers[1][late]
    coefficients = divide(products, np.sqrt(np.maximum(true_power * estimate_power, 0.0)))
    best = int(np.nanargmax(coefficients))
    if nearest:
        best, way = most, 1 if coefficients[most + 1] > coefficients[most - 1] else -1
        while 0 < best < 2 * most and coefficients[best + way] > coefficients[best]:
            best += way
    if best in (0, 2 * most):
        return float(shifts[best])
    before, at, after = coefficients[best - 1 : best + 2]
    bend = before - 2.0 * at + after
    return float(shifts[best] + (0.5 * (before - after) / bend if bend < 0.0 else 0.0))


def _centre(signal: Array) -> Array:
    """Return a signal without its mean; a constant one becomes zero without rounding errors."""
    constant = signal.max(axis=0) == signal.min(axis=0)
    return np.where(constant, 0.0, signal - signal.mean(axis=0))


def _compare(first: Array, second: Array, weights: Array) -> Array:
    """Return (f.s)^2 / (f.f s.s) of the columns, with weights of the rows."""
    product, own, other = (
        np.einsum("t,t...,t...->...", weights, a, b)
        for a, b in ((first, second), (first, first), (second, second))
    )
    # Two quotients: the product of both squares could overflow or vanish.
    return divide(product, own) * divide(product, other)


def divide(numerator: Array, denominator: Array) -> Array:
    """Divide arrays of any shapes that fit together; NaN where the denominator is zero."""
    quotient = np.full(np.broadcast_shapes(np.shape(numerator), np.shape(denominator)), np.nan)
    np.divide(numerator, denominator, out=quotient, where=np.asarray(denominator) != 0.0)
    return quotient
