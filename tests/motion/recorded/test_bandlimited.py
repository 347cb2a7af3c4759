"""The band-limited function: sinusoids, their derivatives, no images, no aliases."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.motion.recorded.gridding import BandLimited

SOURCE = 20.0
LENGTH = 60.0
TONES = ((0.21, 1.0, 0.3), (1.7, 0.4, 1.1), (7.4, 0.2, -0.7))  # Hz, m, rad; all below 0.4 x 20 Hz


def tones(time: np.ndarray, order: int = 0, parts: tuple = TONES) -> np.ndarray:
    """Derivative of that order of the sum of sinusoids."""
    total = np.zeros(len(time))
    for frequency, amplitude, phase in parts:
        omega = 2 * np.pi * frequency
        total += amplitude * omega**order * np.sin(omega * time + phase + order * np.pi / 2)
    return total


def through(parts: tuple = TONES, rate: float = SOURCE, cutoff: float = 8.0) -> BandLimited:
    time = np.arange(0.0, LENGTH, 1 / rate)
    return BandLimited(tones(time, parts=parts) + 3.0 - 0.1 * time, 0.0, 1 / rate, cutoff)


@pytest.mark.parametrize("rate", [100.0, 37.5, 31.4159])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_sinusoids_come_back_on_any_grid_with_their_derivatives(rate: float, order: int) -> None:
    count = int(50 * rate)
    time = 5.0 + np.arange(count) / rate
    line = (3.0 - 0.1 * time, np.full(count, -0.1), np.zeros(count))[order]
    expected = tones(time, order) + line
    error = through().on_grid(5.0, rate, count, order) - expected
    assert np.max(np.abs(error)) < 1e-3 * np.max(np.abs(expected))


def test_upsampling_puts_nothing_above_the_source_nyquist() -> None:
    values = through().on_grid(5.0, 100.0, 5000)
    power = np.abs(np.fft.rfft((values - np.mean(values)) * np.blackman(5000))) ** 2
    frequency = np.fft.rfftfreq(5000, 0.01)
    assert power[frequency > 10.0].sum() < 1e-8 * power.sum()


def test_downsampling_removes_what_the_new_rate_cannot_hold() -> None:
    """A tone of 7.4 Hz would come back at 2.6 Hz on a grid of 10 Hz."""
    low = TONES[:2]
    time = 5.0 + np.arange(500) / 10.0
    values = through(cutoff=4.0).on_grid(5.0, 10.0, 500)
    assert np.max(np.abs(values - (tones(time, parts=low) + 3.0 - 0.1 * time))) < 1e-3


def test_integrating_back_gives_what_was_differentiated() -> None:
    """Up to the ends, on noise: one function, not three estimates."""
    noise = np.random.default_rng(1).standard_normal(1200)
    function = BandLimited(noise, 0.0, 0.05, 4.0)
    rate, count = 400.0, 23980
    for order in (0, 1):
        lower, upper = (function.on_grid(0.0, rate, count, k) for k in (order, order + 1))
        back = lower[0] + np.concatenate([[0], np.cumsum(upper[1:] + upper[:-1])]) / (2 * rate)
        assert np.max(np.abs(back - lower)) < 5e-4 * np.max(np.abs(lower))


def test_noise_is_amplified_as_stated() -> None:
    """(2 pi f)^2 s sqrt(2 f / (5 fs)) and its like, for an ideal filter at the cut-off."""
    noise = np.random.default_rng(2).standard_normal(40000)
    function = BandLimited(noise, 0.0, 0.01, 5.0)
    for order, power in ((1, 3), (2, 5)):
        deviation = np.std(function.on_grid(20.0, 100.0, 36000, order))
        ideal = (2 * np.pi * 5.0) ** order * np.sqrt(2 * 5.0 / (power * 100.0))
        assert 1.0 < deviation / ideal < 1.45  # the roll-off to 1.25 x adds to it
