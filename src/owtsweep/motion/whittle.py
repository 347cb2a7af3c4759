"""Fits Eq. (1) of Ren et al. (2019) to a record by Whittle's likelihood.

A line is one frequency f_j of the record's periodogram; its height is I_j. Whittle's likelihood
(Whittle, 1953) takes the heights as independent and exponentially distributed with the mean S(f_j).
Minus the logarithm of the likelihood is the sum of log S(f_j) + I_j / S(f_j) over the lines inside
a band. S is written with its peak frequency f* and its half-bandwidth sqrt(k) (see
`source.translated`): S = a f / ((f - f*)^2 + (k / f*) f), so c = f*^2 and b = -2 f* + k / f*. For
given f* and k the best a is the mean of I_j / (S(f_j) / a), so only f* and k are searched.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.source import Spectrum

#: The default band, Hz: that of waves and of the first bending mode of a support structure.
BAND = (0.05, 0.6)
#: Three parameters are fitted to at least this many lines of the periodogram.
FEWEST_LINES = 12
#: The fit warns that the shape is doubtful if `Fit.probability` is below this.
DOUBTFUL = 0.01
#: Records with more samples are transformed axis by axis, in place, and cut to a length that suits
#: the FFT. With an unsuitable length the FFT can need ten times the memory.
LONG = 1 << 22


@dataclass(frozen=True)
class Fit:
    """A spectrum S(f), Eq. (1), fitted to a record, and measures of how well the spectrum fits.

    spectrum: the fitted coefficients a, b, c of the one-sided density, m^2/Hz.
    natural_period: 1 divided by the frequency of the peak, s.
    bandwidth: Square of the half-bandwidth, s^-2.
    errors: Standard errors of a, b, c, natural_period, bandwidth and half_bandwidth, from the
        expected Hessian of the likelihood (the Fisher information); valid if the shape of Eq. (1)
        is right.
    band, lines: Lower and upper edge of the fitted band, Hz, and the number of lines inside the
        band.
    band_share: Share of the record's variance (mean and trend removed) that lies inside the band.
    explained: Share of the band's variance that the fitted curve accounts for: the area that lies
        under both curves, smoothed over 9 lines, divided by that under the periodogram. A curve of
        the right shape reaches about 0.87, because the periodogram scatters.
    probability: the p-value of Bartlett's test that the shape of Eq. (1) is right. If it is, the
        accumulated I_j / S(f_j) are a straight line up to scatter, and this is the probability of a
        departure at least as large as observed. The value tends to be too large, because the shape
        was fitted to the record itself.
    warnings: What is wrong with the fit, in words; empty for a good fit.
    """

    spectrum: Spectrum
    natural_period: float
    bandwidth: float
    errors: dict[str, float]
    band: tuple[float, float]
    lines: int
    band_share: float
    explained: float
    probability: float
    warnings: tuple[str, ...]

    @property
    def half_bandwidth(self) -> float:
        """The half-bandwidth, the square root of `bandwidth`, Hz."""
        return float(np.sqrt(self.bandwidth))


def periodogram(position: Array, step: float) -> tuple[Array, Array]:
    """Compute the one-sided periodogram of a record; mean and linear trend are removed first.

    `position` is in m, shape (n,), or (axes, n): the periodograms of the axes are added.

    Return frequencies in Hz and spectral densities in m^2/Hz, shape (n // 2,) each, without the
    frequency zero. The sum of density / (n step) is the variance. Of a record with more than `LONG`
    samples, up to 4 in 1000 samples at the end may be left out.
    """
    from scipy.fft import rfft

    series = np.atleast_2d(np.asarray(position, dtype=float))
    n = series.shape[1]
    if n > LONG:
        return _long_periodogram(series, step)
    trend = np.vstack([np.ones(n), np.linspace(-1.0, 1.0, n)])
    flat = series - (series @ np.linalg.pinv(trend)) @ trend
    lines = rfft(flat, axis=1)
    return _make_one_sided(np.sum(np.abs(lines) ** 2, axis=0), n, step)


def _long_periodogram(series: Array, step: float) -> tuple[Array, Array]:
    """Compute the one-sided periodogram of a long record, shape (axes, n), in little memory.

    The last samples, at most 4 in 1000, are left out. Mean and trend are removed one after the
    other, since a straight line over [-1, 1] has the mean zero.
    """
    from scipy.fft import next_fast_len, rfft

    n = series.shape[1]
    while next_fast_len(n) != n:
        n -= 1
    power = np.zeros(n // 2 + 1)
    for axis in series:
        flat = np.array(axis[:n])
        flat -= flat.mean()
        line = np.linspace(-1.0, 1.0, n)
        line *= (line @ flat) / (line @ line)
        flat -= line
        del line
        lines = rfft(flat, overwrite_x=True)
        power += np.square(lines.real)
        power += np.square(lines.imag)
        del flat, lines
    return _make_one_sided(power, n, step)


def _make_one_sided(power: Array, n: int, step: float) -> tuple[Array, Array]:
    """Scale squared Fourier coefficients of n samples to a one-sided density, in place.

    Return frequencies (Hz) and density (m^2/Hz), without the frequency zero.
    """
    power *= 2.0 * step / n
    if n % 2 == 0:
        power[-1] *= 0.5
    frequency = np.arange(len(power)) / (n * step)
    return frequency[1:], power[1:]


def fit(position: Array, step: float, *, band: tuple[float, float] = BAND) -> Fit:
    """Fit the spectrum of Eq. (1) of Ren et al. (2019) to a record.

    `position` is in m, shape (n,), or (axes, n): the sum of the axes' spectra is fitted. The edges
    of the band are in Hz, inclusive. Raise `InputError` if fewer than `FEWEST_LINES` lines of the
    periodogram lie in the band, if the record has no motion in the band, or if positions are
    missing.
    """
    return fit_lines(*periodogram(position, step), band=band)


def fit_lines(frequency: Array, power: Array, *, band: tuple[float, float] = BAND) -> Fit:
    """Fit the spectrum of Eq. (1) of Ren et al. (2019) to what `periodogram` returns.

    Arguments and errors are those of `fit`.
    """
    df = float(frequency[0])
    inside = (frequency >= band[0] * (1 - 1e-9)) & (frequency <= band[1] * (1 + 1e-9))
    f, observed = frequency[inside], power[inside]
    if len(f) < FEWEST_LINES:
        raise InputError(
            f"band: [{band[0]:g}, {band[1]:g}] Hz holds {len(f)} lines of the periodogram "
            f"of a record of {1 / df:.4g} s; at least {FEWEST_LINES} are needed: widen the band "
            "or use a longer record"
        )
    if not np.all(np.isfinite(power)) or observed.sum() <= 1e-24 * len(f):
        raise InputError(
            "position: the record does not move inside the band, or has missing values"
        )
    peak, k = _search(f, observed, df, band)
    shape = _shape(f, peak, k)
    a = float(np.mean(observed / shape))
    found = Fit(
        spectrum=Spectrum(a=a, b=-2.0 * peak + k / peak, c=peak**2),
        natural_period=1.0 / peak,
        bandwidth=k,
        errors=_estimate_errors(f, a, peak, k),
        band=band,
        lines=len(f),
        band_share=float(observed.sum() / power.sum()),
        explained=_measure_overlap(observed, a * shape),
        probability=_test_shape(observed / (a * shape)),
        warnings=(),
    )
    doubts = _list_doubts(found, peak, df, largest=f[int(np.argmax(observed))])
    return replace(found, warnings=tuple(doubts))


def _shape(f: Array, peak: float, k: float) -> Array:
    return f / ((f - peak) ** 2 + (k / peak) * f)


def _search(f: Array, observed: Array, df: float, band: tuple[float, float]) -> tuple[float, float]:
    """Find the peak frequency (Hz) and squared half-bandwidth (s^-2) of greatest likelihood.

    The search begins on a coarse grid and ends with Nelder and Mead's simplex method. `f` (Hz) and
    `observed` (m^2/Hz) are the lines inside `band`; `df` is the distance between two lines, Hz.
    """
    from scipy.optimize import minimize

    lowest, highest = np.log(band[0] / 3.0), np.log(band[1] * 3.0)
    narrow, broad = np.log((0.05 * df) ** 2), np.log((2.0 * band[1]) ** 2)

    def cost(parameters: Array) -> float:
        if not (lowest <= parameters[0] <= highest and narrow <= parameters[1] <= broad):
            return np.inf
        shape = _shape(f, float(np.exp(parameters[0])), float(np.exp(parameters[1])))
        return float(np.log(np.mean(observed / shape)) + np.mean(np.log(shape)))

    largest = f[np.argsort(observed)[::-1][:3]]
    peaks = np.log(np.concatenate([np.geomspace(band[0], band[1], 40), largest]))
    widths = np.linspace(np.log((0.3 * df) ** 2), np.log(band[1] ** 2), 16)
    starts = sorted((cost(np.array([p, w])), p, w) for p in peaks for w in widths)[:3]
    options = {"xatol": 1e-9, "fatol": 1e-13, "maxiter": 2000}
    minima = [minimize(cost, [p, w], method="Nelder-Mead", options=options) for _, p, w in starts]
    best = min(minima, key=lambda minimum: float(minimum.fun)).x
    return float(np.exp(best[0])), float(np.exp(best[1]))


def _estimate_errors(f: Array, a: float, peak: float, k: float) -> dict[str, float]:
    """Return the standard errors of a fit: name, as in `Fit.errors`, -> standard error.

    They come from the Fisher information: the sum, over the lines `f` (Hz), of the outer products
    of the derivatives of log S with respect to a, the peak (Hz) and k (s^-2).
    """
    below = (f - peak) ** 2 + (k / peak) * f
    of_peak = (2.0 * (f - peak) + (k / peak**2) * f) / below
    slopes = np.array([np.full(len(f), 1.0 / a), of_peak, -(f / peak) / below])  # to a, f*, k
    scale = np.array([a, peak, k])
    scaled = slopes * scale[:, None]
    covariance = np.linalg.pinv(scaled @ scaled.T) * np.outer(scale, scale)
    towards = {
        "a": (1.0, 0.0, 0.0),
        "b": (0.0, -2.0 - k / peak**2, 1.0 / peak),
        "c": (0.0, 2.0 * peak, 0.0),
        "natural_period": (0.0, -1.0 / peak**2, 0.0),
        "bandwidth": (0.0, 0.0, 1.0),
        "half_bandwidth": (0.0, 0.0, 0.5 / np.sqrt(k)),
    }
    return {
        name: float(np.sqrt(np.array(g) @ covariance @ np.array(g))) for name, g in towards.items()
    }


def _measure_overlap(observed: Array, fitted: Array) -> float:
    """Return the area under both smoothed curves, divided by that under the observed one."""
    window = np.ones(9) / 9  # lines
    smooth, curve = (np.convolve(series, window, "valid") for series in (observed, fitted))
    return float(np.minimum(smooth, curve).sum() / smooth.sum())


def _test_shape(ratio: Array) -> float:
    """Return the p-value of Bartlett's test that a fitted spectrum has the right shape.

    `ratio` is the periodogram divided by the fitted spectrum, in order of frequency, shape
    (lines,). If the shape is right, its running sum is a straight line up to scatter.
    """
    from scipy.special import kolmogorov

    n = len(ratio)
    distance = np.abs(np.cumsum(ratio) / ratio.sum() - np.arange(1, n + 1) / n)
    return float(kolmogorov(np.sqrt(n) * np.max(distance)))


def _list_doubts(fit: Fit, peak: float, df: float, largest: float) -> list[str]:
    """Return what is wrong with a fit; frequencies, also that of the largest line, are in Hz."""
    band, half, doubts = fit.band, fit.half_bandwidth, []
    if not band[0] + df <= peak <= band[1] - df:
        doubts.append(
            f"the peak, {peak:.4g} Hz, is at the edge of the band [{band[0]:g}, {band[1]:g}] Hz or "
            "outside: the period is a guess"
        )
    if half < df:
        doubts.append(
            f"the half-bandwidth, {half:.2g} Hz, is below the record's resolution of "
            f"{df:.2g} Hz: it is narrower than this record can tell"
        )
    if half > peak:
        doubts.append("the spectrum is so broad that it has no peak to speak of")
    if fit.probability < DOUBTFUL:
        other = ""
        if abs(largest - peak) > 3 * df:
            other = f"; its largest line is at {largest:.4g} Hz: fit a band around that"
        p = f"p = {fit.probability:.1g}"
        doubts.append(f"one peak of this shape does not describe the record ({p}){other}")
    return doubts
