"""Whittle's fit of Eq. (1): known spectra come back within their standard errors."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize

from owtsweep.errors import InputError
from owtsweep.motion import whittle
from owtsweep.motion.source import SpectralSource, Spectrum, translated
from owtsweep.motion.whittle import fit, periodogram
from owtsweep.streams import stream

STEP = 0.25
STEPS = 8000  # 2000 s


def gaussian(spectrum: Spectrum, seed: int) -> np.ndarray:
    """A record whose lines have random amplitudes too, as Whittle's likelihood takes them."""
    rng = np.random.default_rng(seed)
    n = 8 * STEPS
    frequency = np.arange(n // 2 + 1) / (n * STEP)
    density = np.where(frequency > 0, spectrum.density(np.maximum(frequency, 1e-9)), 0.0)
    normal = rng.standard_normal((2, n // 2 + 1))
    lines = (normal[0] + 1j * normal[1]) * np.sqrt(density / (4 * n * STEP)) * n
    return np.fft.irfft(lines, n)[:STEPS]


@pytest.mark.parametrize(("period", "bandwidth"), [(4.0, 2.4e-4), (8.0, 2e-3)])
def test_synthesised_records_give_back_their_period_and_bandwidth(
    period: float, bandwidth: float
) -> None:
    source = SpectralSource(translated(period, bandwidth), (0.02, 1.0))
    fits = []
    for replicate in range(16):
        draws = partial(stream, 1, "whittle", (period,), replicate)
        motion = source.realise(draws, steps=STEPS, step=STEP)
        fits.append(fit(motion.position, STEP))
    score = np.array(
        [
            [
                (one.natural_period - period) / one.errors["natural_period"],
                (one.bandwidth - bandwidth) / one.errors["bandwidth"],
            ]
            for one in fits
        ]
    )
    assert np.all(np.sqrt(np.mean(score**2, axis=0)) < 1.0)
    assert abs(np.mean([one.natural_period for one in fits]) / period - 1) < 0.01
    assert all(not one.warnings for one in fits)
    assert min(one.explained for one in fits) > 0.75


def test_standard_errors_are_those_of_gaussian_records() -> None:
    truth = translated(5.0, 2e-3)
    fits = [fit(gaussian(truth, seed), STEP) for seed in range(100, 148)]
    for name, value in (("natural_period", 5.0), ("bandwidth", 2e-3), ("a", truth.a)):
        got = [getattr(one, name, one.spectrum.a) for one in fits]
        score = [(x - value) / one.errors[name] for x, one in zip(got, fits, strict=True)]
        assert 0.75 < np.sqrt(np.mean(np.square(score))) < 1.35, name
    assert np.mean([one.probability < 0.05 for one in fits]) < 0.15


def test_a_plain_search_over_a_b_c_finds_the_same_minimum() -> None:
    record = gaussian(translated(5.0, 2e-3), 7)
    fitted = fit(record, STEP)
    frequency, power = periodogram(record, STEP)
    inside = (frequency >= 0.05) & (frequency <= 0.6)
    f, observed = frequency[inside], power[inside]

    def cost(abc: np.ndarray) -> float:
        below = f**2 + abc[1] * f + abc[2]
        if abc[0] <= 0 or below.min() <= 0:
            return np.inf
        density = abc[0] * f / below
        return float(np.sum(np.log(density) + observed / density))

    best = fitted.spectrum
    start = np.array([best.a, best.b, best.c])
    options = {"xatol": 1e-10, "fatol": 1e-10, "maxiter": 4000}
    for shift in (1.0, 1.003):
        other = minimize(cost, start * [1, 1, shift], method="Nelder-Mead", options=options)
        assert cost(start) <= other.fun + 1e-5


def test_periodogram_sums_to_the_variance_and_has_the_level_of_the_spectrum() -> None:
    record = gaussian(translated(5.0, 2e-3), 3)
    slope = 3.0 + 0.01 * np.arange(STEPS)
    frequency, power = periodogram(record + slope, STEP)
    flat = record - np.polynomial.Polynomial.fit(np.arange(STEPS), record, 1)(np.arange(STEPS))
    assert power.sum() * frequency[0] == pytest.approx(np.var(flat), rel=1e-9)
    fitted = fit(record, STEP)
    area = quad(lambda f: float(fitted.spectrum.density(np.array(f))), 0.05, 0.6, limit=200)[0]
    assert area == pytest.approx(np.var(flat) * fitted.band_share, rel=0.02)


def test_two_axes_are_one_direction_seen_from_north() -> None:
    record = gaussian(translated(4.0, 2e-3), 9)
    both = np.array([np.cos(0.5) * record, np.sin(0.5) * record])
    one, two = fit(record, STEP), fit(both, STEP)
    assert two.natural_period == pytest.approx(one.natural_period, rel=1e-6)
    assert two.spectrum.a == pytest.approx(one.spectrum.a, rel=1e-6)


def test_bad_fits_are_said() -> None:
    record = gaussian(translated(4.0, 2e-3), 1)
    assert any("edge of the band" in text for text in fit(record, STEP, band=(0.3, 1.0)).warnings)
    second = gaussian(translated(10.0, 2.4e-4), 2)
    twin = fit(record / record.std() + 2 * second / second.std(), STEP)
    assert any("one peak" in text for text in twin.warnings)
    time = STEP * np.arange(STEPS)
    line = np.sin(2 * np.pi * 0.2501 * time) + 1e-3 * record / record.std()
    assert any("resolution" in text for text in fit(line, STEP).warnings)


def test_what_cannot_be_fitted_is_refused() -> None:
    with pytest.raises(InputError, match="holds 6 lines"):
        fit(np.sin(np.arange(40.0)), STEP)
    with pytest.raises(InputError, match="does not move"):
        fit(np.zeros(STEPS), STEP)
    with pytest.raises(InputError, match="missing values"):
        fit(np.full(STEPS, np.nan), STEP)


@pytest.mark.parametrize("steps", [8000, 7999, 7997])  # 7999 = 19 x 421; 7997 = 11 x 727
def test_a_long_record_has_the_same_lines(monkeypatch: pytest.MonkeyPatch, steps: int) -> None:
    series = np.stack([gaussian(translated(5.0, 1e-3), seed)[:steps] for seed in range(2)])
    series += np.outer([3.0, -1.0], np.linspace(0.0, 4.0, steps)) + 7.0
    kept = {8000: 8000, 7999: 7986, 7997: 7986}[steps]  # 7986 = 2 x 3 x 11^3
    frequency, power = periodogram(series[:, :kept], STEP)
    monkeypatch.setattr(whittle, "LONG", 100)
    before = series.copy()
    spectrum = periodogram(series, STEP)
    assert np.array_equal(series, before)
    np.testing.assert_allclose(spectrum[0], frequency, rtol=1e-12)
    np.testing.assert_allclose(spectrum[1], power, rtol=1e-7, atol=1e-12 * power.max())
