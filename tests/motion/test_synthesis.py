"""Synthesised records: variance, band, normalisation, derivatives, the moments before t = 0."""

from __future__ import annotations

import tracemalloc
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.stats import kstest

from owtsweep.errors import InputError
from owtsweep.motion.source import Motion, SpectralSource, Spectrum, lines, translated
from owtsweep.streams import stream

BAND = (0.05, 0.6)
STEP = 0.05
STEPS = 8192
SHAPE = translated(4.0, 2e-2)  # broad enough to be resolved by this record's lines


def draw(replicate: int = 0, shape: Spectrum = SHAPE, **changes) -> Motion:
    how = {name: changes.pop(name) for name in ("band", "normalise") if name in changes}
    source = SpectralSource(shape, **{"band": BAND, **how})
    return source.realise(
        partial(stream, 1, "test", (4.0,), replicate), **{"steps": STEPS, "step": STEP, **changes}
    )


def whole_period(shape: Spectrum = SHAPE, **changes) -> NDArray[np.float64]:
    """Both halves of the FFT's period, in time order: history, then the record."""
    motion = draw(shape=shape, history=STEPS, **changes)
    return np.concatenate([motion.before, motion.position])


def test_lines_carry_the_variance_of_the_spectrum() -> None:
    """Unscaled, the variance over the period is the integral of S over the band."""
    numbers, frequency = lines(BAND, 2 * STEPS * STEP)
    series = whole_period()
    power = np.abs(np.fft.rfft(series)) ** 2
    share = power[numbers] / power.sum()
    expected = quad(lambda f: float(SHAPE.density(np.array(f))), *BAND, points=[0.25])[0]
    df = 1 / (2 * STEPS * STEP)
    assert SHAPE.density(frequency).sum() * df == pytest.approx(expected, rel=2e-3)
    np.testing.assert_allclose(share, SHAPE.density(frequency) * df / expected, rtol=2e-3)


def test_normalisations() -> None:
    assert np.max(np.abs(draw().position)) == pytest.approx(1.0, rel=1e-14)
    assert np.std(draw(normalise="rms").position) == pytest.approx(1.0, rel=1e-14)
    peak, rms = draw(), draw(normalise="rms")
    np.testing.assert_allclose(
        rms.acceleration / rms.position[0], peak.acceleration / peak.position[0], rtol=1e-10
    )


def test_periodogram_is_confined_to_the_band() -> None:
    power = np.abs(np.fft.rfft(whole_period())) ** 2
    f = np.fft.rfftfreq(2 * STEPS, STEP)
    inside = (f >= BAND[0] - 1e-9) & (f <= BAND[1] + 1e-9)
    assert power[~inside].max() < 1e-20 * power[inside].max()
    assert np.all(power[inside] > 1e-6 * power[inside].max())


def test_derivatives_are_those_of_the_displacement() -> None:
    motion = draw()
    # spectral differentiation over the whole period, of which the record is the second half here
    series = whole_period()
    omega = 2 * np.pi * np.fft.rfftfreq(2 * STEPS, STEP)
    for order, found in ((1, motion.velocity), (2, motion.acceleration)):
        spectral = np.fft.irfft((1j * omega) ** order * np.fft.rfft(series), n=2 * STEPS)[STEPS:]
        assert np.max(np.abs(found - spectral)) < 1e-10 * np.max(np.abs(found))
    # central differences err by omega^2 step^2 / 6 at most
    error = (2 * np.pi * BAND[1] * STEP) ** 2 / 6
    for integral, found in (
        (motion.position, motion.velocity),
        (motion.velocity, motion.acceleration),
    ):
        central = (integral[2:] - integral[:-2]) / (2 * STEP)
        assert np.max(np.abs(central - found[1:-1])) < error * np.max(np.abs(found))


def test_history_continues_the_record_smoothly() -> None:
    motion = draw(history=20)
    assert len(motion.before) == 20
    joined = np.concatenate([motion.before, motion.position[:20]])
    # extrapolating the record backwards by its own derivatives meets the history
    back = motion.position[0] - STEP * motion.velocity[0] + STEP**2 / 2 * motion.acceleration[0]
    assert motion.before[-1] == pytest.approx(back, abs=STEP**3 * 8.0)
    inside = np.max(np.abs(np.diff(motion.position, 3)))
    assert np.max(np.abs(np.diff(joined, 3))) <= inside


def test_delayed_positions_reach_into_the_history() -> None:
    motion = draw(history=7)
    whole = np.concatenate([motion.before, motion.position])
    np.testing.assert_array_equal(motion.position_at(-7, 5, 100), whole[:500:5])
    np.testing.assert_array_equal(motion.position_at(0, 5, 100), motion.position[:500:5])
    np.testing.assert_array_equal(motion.position_at(3, 1, 4), motion.position[3:7])
    with pytest.raises(ValueError, match="holds 7 steps before"):
        motion.position_at(-8, 5, 10)


def test_nothing_repeats_inside_the_record() -> None:
    motion = draw()
    p = motion.position - motion.position.mean()
    for lag in (STEPS // 4, STEPS // 2, 3 * STEPS // 4):
        assert abs(np.corrcoef(p[lag:], p[:-lag])[0, 1]) < 0.9


@pytest.mark.parametrize("band", [(0.05, 0.5), (0.1, 0.6), (0.2, 0.3)])
def test_moving_a_band_edge_keeps_the_phases(band: tuple[float, float]) -> None:
    kept, _ = lines(band, 2 * STEPS * STEP)
    before, after = (np.fft.rfft(s)[kept] for s in (whole_period(), whole_period(band=band)))
    assert len(kept) > 50
    np.testing.assert_allclose(np.angle(after / before), 0.0, atol=1e-8)


def test_phases_are_uniform() -> None:
    numbers, _ = lines(BAND, 2 * STEPS * STEP)
    phases = np.angle(np.fft.rfft(np.roll(whole_period(), STEPS))[numbers]) / (2 * np.pi) % 1.0
    assert kstest(phases, "uniform").pvalue > 0.01


def test_lines_stand_at_multiples_inside_the_band_edges_included() -> None:
    numbers, frequency = lines((0.05, 0.6), 200.0)
    assert (numbers[0], numbers[-1]) == (10, 120)
    np.testing.assert_allclose(frequency, numbers / 200.0)
    with pytest.raises(InputError, match=r"^band: \[0\.051, 0\.052\] Hz holds no line"):
        lines((0.051, 0.052), 100.0)


def test_same_stream_same_bits_other_replicate_other_record() -> None:
    np.testing.assert_array_equal(draw().acceleration, draw().acceleration)
    assert not np.allclose(draw(0).position, draw(1).position)


@pytest.mark.parametrize("steps", [4001, 20_000])
def test_a_record_is_one_plain_transform_of_its_lines(steps: int) -> None:
    shape, step, history = translated(5.0), 0.05, 7

    draws = partial(stream, 1, "test", (5.0,), 0)
    found = SpectralSource(shape, BAND).realise(draws, steps=steps, step=step, history=history)
    numbers, frequency = lines(BAND, 2 * steps * step)
    drawn = draws("phase").random(numbers[-1] + 1)[numbers]
    bins = np.zeros((3, steps + 1), dtype=complex)
    for order, row in enumerate(bins):
        rate = (2j * np.pi * frequency) ** order
        row[numbers] = rate * np.sqrt(shape.density(frequency)) * np.exp(2j * np.pi * drawn)
    plain = np.fft.irfft(bins, n=2 * steps)
    plain /= np.max(np.abs(plain[0, :steps]))
    for one, series in zip(
        plain, (found.position, found.velocity, found.acceleration), strict=True
    ):
        np.testing.assert_allclose(series, one[:steps], rtol=0, atol=1e-13 * np.max(np.abs(one)))
    np.testing.assert_allclose(found.before, plain[0, -history:], rtol=0, atol=1e-13)
    for first in (-7, -3, 0, 2):
        whole = np.concatenate([found.before, found.position])
        expected = whole[7 + first :: 3][:900]
        assert np.array_equal(found.position_at(first, 3, 900), expected)


def test_a_long_record_is_made_in_little_more_memory_than_two_of_its_series() -> None:
    steps = 400_000
    tracemalloc.start()
    try:
        draw(steps=steps, history=40)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    series = 8 * steps
    assert peak - 3 * series < 2.2 * 2 * series  # three series are the record itself
