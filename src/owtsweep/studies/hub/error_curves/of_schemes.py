"""Computes the curves of the study's schemes, or reads them from the cache, and sums over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache

import numpy as np

from owtsweep.arrays import Array
from owtsweep.io.cache import cached
from owtsweep.motion.source import Spectrum, lines
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import SCHEMES, Known, resolve
from owtsweep.studies.hub.error_curves.curves import Curves, curves
from owtsweep.studies.hub.known_motion import peak_factors
from owtsweep.studies.hub.sensors import Sensors


@lru_cache(maxsize=8)
def weigh_beats(count: int) -> tuple[Array, int]:
    """Return the weights of the beats of a record's lines, and a number of values.

    A sum over all pairs of `count` lines, of x_m x_n and of the square of the mean that the beat of
    the lines number m and n has over a record, is the weighted sum of the squares of x's Fourier
    transform of so many values, divided by their number. The weights have the shape
    (size // 2 + 1,). The common period of all lines is twice the record's duration. Over the
    record, the beat therefore has the mean sin(pi (m - n) / 2) / (pi (m - n) / 2).
    """
    from scipy.fft import next_fast_len, rfft

    size = next_fast_len(2 * count, real=True)
    apart = np.minimum(np.arange(size), size - np.arange(size))
    beat = np.where(apart < count, np.sinc(0.5 * apart) ** 2, 0.0)
    beat[0] = 0.0  # a line does not beat with itself
    weights: Array = rfft(beat).real
    # Parseval for real sequences: all terms count twice except the first and, for an even length,
    # the last
    weights[1 : (size + 1) // 2] *= 2.0
    return weights, size


def expected_ratio(spectrum: Spectrum, curves: Array, frequency: Array) -> Array:
    """Compute the expected mean square error of records normalised to a standard deviation of 1 m.

    The squared error of a normalised record is a ratio p / q of two random sums, the squared error
    and the variance before normalisation. To second order in the scatter of the records, the
    expectation of the ratio is E[p / q] = E p / E q (1 + var q / (E q)^2 - cov(p, q) / (E p E q)).
    (The term var q / (E q)^2 is 0.3 % for the default records, and more for narrower spectra and
    shorter records.) The beat of two lines in the error is approximated by their beat in the
    motion, times the geometric mean of the curve at both lines.

    curves: mean square errors per mean square of the motion, at the n lines; shape (..., n).
    frequency: the n lines (sinusoids) of which the records consist, Hz, evenly spaced, shape (n,).
    Returns: shape (...), in the unit of the curves times m^2.
    """
    from scipy.fft import rfft

    weights, size = weigh_beats(len(frequency))
    share = spectrum.density(frequency)
    share = share / np.sum(share)
    mean = np.sum(share * curves, axis=-1)
    flat = curves.reshape(-1, len(share))
    shapes = np.concatenate([np.ones((1, len(share))), flat]) ** 0.5 * share
    beats = np.sum(np.abs(rfft(shapes, n=size, axis=-1)) ** 2 * weights, axis=-1) / size
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
    _, frequency = lines((config.band[0], config.band[1]), 2.0 * config.record.duration)
    at_lines = curve.at(frequency)
    expected = np.array(
        [expected_ratio(config.spectrum.at(period), at_lines, frequency) for period in periods]
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
