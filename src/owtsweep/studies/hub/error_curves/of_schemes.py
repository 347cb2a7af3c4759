"""Computes the curves of the study's schemes, or reads them from the cache, and sums over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import Spectrum, spectrum
from owtsweep.motion.synthesis import lines
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.cache import cached
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.error_curves.curves import Curves, curves
from owtsweep.studies.hub.listed import SCHEMES, resolve
from owtsweep.studies.hub.peak import peak_factors
from owtsweep.studies.hub.sensors import Sensors


@dataclass(frozen=True)
class Lines:
    """The spectral lines (sinusoids) of which records of one length consist.

    frequency: of the lines, Hz, evenly spaced, shape (n,).
    beat: Fourier transform, shape (size // 2 + 1,), of a function b of the difference of two lines'
        numbers: the square of the mean that the beat of the two lines has over a record; b(0) = 0.
    size: number of values of b that are transformed, at least 2 n.
    """

    frequency: Array
    beat: Array
    size: int


def lines_of(band: tuple[float, float], duration: float) -> Lines:
    """Return the spectral lines inside a band (Hz) of records of a duration (s).

    The common period of all lines is twice the record's duration. Over the record, the beat of the
    lines number m and n therefore has the mean sin(pi (m - n) / 2) / (pi (m - n) / 2).
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
    """Compute the expected mean square error of records normalised to a standard deviation of 1 m.

    The squared error of a normalised record is a ratio p / q of two random sums, the squared error
    and the variance before normalisation. To second order in the scatter of the records, the
    expectation of the ratio is E[p / q] = E p / E q (1 + var q / (E q)^2 - cov(p, q) / (E p E q)).
    (The term var q / (E q)^2 is 0.3 % for the default records, and more for narrower spectra and
    shorter records.) The beat of two lines in the error is approximated by their beat in the
    motion, times the geometric mean of the curve at both lines.

    curves: mean square errors per mean square of the motion, at the n lines; shape (..., n).
    drawn: the spectral lines of the records.
    Returns: shape (...), in the unit of the curves times m^2.
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


#: Version of the expected errors. Raise it when they change and the study's `numerics_version`
#: stays the same.
EXPECTED_VERSION = 2


def curves_of(config: HubConfig, name: str) -> Curves:
    """Compute a scheme's curves, or recall them if changes of its code would be noticed."""
    sensors = sensing.sensors(config.sensors)
    steps = round(config.record.duration / sensors.step)
    settled = config.measures.find_settled(sensors.step)
    entry = {resolve(entry).name: entry for entry in SCHEMES.list_entries(config)}[name]
    scheme = resolve(entry)
    what = {
        "what": "curves",
        "version": EXPECTED_VERSION,
        "sensors": asdict(sensors),
        "scheme": SCHEMES.describe_content(config, entry, scheme),
        "steps": steps,
        "settled": settled,
        "band": list(config.band),
    }

    def compute() -> dict[str, Array]:
        chain = scheme.kernel(Known(sensors, config), steps)
        return vars(curves(chain, sensors, steps=steps, settled=settled, band=config.band))

    if SCHEMES.explain_recompute(scheme):
        return Curves(**compute())
    return Curves(**cached(what, compute))


def motion_of(config: HubConfig, curve: Curves, periods: Sequence[float]) -> Array:
    """Compute the expected mean square error due to motion of amplitude 1 m at natural periods (s).

    The axes of the result are natural period, measure (position, velocity), window (full, settled).
    """
    lines = lines_of((config.band[0], config.band[1]), config.record.duration)
    at_lines = curve.at(lines.frequency)
    kind, bandwidth = config.spectrum.kind, config.spectrum.bandwidth
    expected = np.array(
        [expected_ratio(spectrum(kind, period, bandwidth), at_lines, lines) for period in periods]
    )
    if config.normalise == "peak":
        expected *= peak_factors(config, periods)[:, None, None]
    return expected


def noise_of(config: HubConfig, sensors: Sensors, curve: Curves) -> Array:
    """Compute the error variance of each axis due to what the motion does not change.

    That are noise, the initial bias and gravity, which are constant forces. The axes of the result
    are axis (x, y), measure (position, velocity), window (full, settled).
    """
    bias = np.full(2, config.sensors.imu.bias_initial)
    constant = sensors.rotation @ bias - np.array(sensors.gravity)
    of_constant = (constant**2)[:, None, None] * curve.constant
    return np.asarray(curve.noise.sum(axis=0) + of_constant)
