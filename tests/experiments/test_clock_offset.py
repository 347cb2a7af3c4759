"""Offsets of clocks: swings of a blade seen by two systems whose offset is known."""

import numpy as np
import pytest

from experiments.maes2018.clock_offset import find_offset

DURATION, NOISE = 300.0, 0.003


def make_altitude(seed):
    """Return the altitude, m, of a blade's root as a function of time: two swings, .1 m rms."""
    rng = np.random.default_rng(seed)
    w = 2 * np.pi / rng.uniform([6.0, 9.0], [9.0, 14.0])
    size, phase = rng.uniform(0.06, 0.14, 2), rng.uniform(0.0, 2 * np.pi, 2)
    return lambda t: 30.0 + np.sin(np.multiply.outer(t, w) + phase) @ size


def see(altitude, rate, seed, *, ahead=0.0, noise=NOISE, jitter=0.0):
    """Return time stamps and noisy altitudes of a sensor whose clock is ahead."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(DURATION * rate)) / rate
    t = t + rng.uniform(-jitter, jitter, len(t))
    return t + ahead, altitude(t) + noise * rng.normal(size=len(t))


@pytest.mark.parametrize("rate", [50.0, 5.0])
@pytest.mark.parametrize("offset", [0.1, -0.1])
def test_finds_a_tenth_of_a_second_within_10_ms(rate, offset):
    errors = []
    for seed in range(10):
        altitude = make_altitude(seed)
        ins = see(altitude, rate, [seed, 1])
        stations = see(altitude, 1.0, [seed, 2], ahead=offset, jitter=0.3)
        errors.append(find_offset(*ins, *stations, 0.5) - offset)
    assert np.abs(errors).max() < 0.01
    assert np.std(errors) < 0.005


def test_is_as_good_as_least_squares_allows():
    """With noise in the sparse record alone: the bound is sigma over the speed's sum of squares."""
    errors, bounds = [], []
    for seed in range(40):
        altitude = make_altitude(seed)
        ins = see(altitude, 5.0, 0, noise=0.0)
        times, values = see(altitude, 1.0, [seed, 3], jitter=0.3)
        errors.append(find_offset(*ins, times, values, 0.5))
        speed = (altitude(times + 1e-4) - altitude(times - 1e-4)) / 2e-4
        bounds.append(NOISE / np.sqrt(speed @ speed))
    z = np.array(errors) / bounds
    assert 0.75 < np.sqrt(np.mean(z**2)) < 1.25
    assert abs(z.mean()) < 3 / np.sqrt(len(z))


def test_without_noise_it_is_found_to_the_tenth_of_a_millisecond():
    altitude = make_altitude(3)
    for offset in (0.0, 0.0137, -0.49, 2.71):
        ins = see(altitude, 50.0, 1, noise=0.0)
        stations = see(altitude, 1.0, 2, ahead=offset, noise=0.0, jitter=0.3)
        assert find_offset(*ins, *stations, 3.0) == pytest.approx(offset, abs=1e-4)


def test_a_factor_and_a_constant_do_not_matter():
    altitude = make_altitude(5)
    t, z = see(altitude, 50.0, 1)
    stamps, seen = see(altitude, 1.0, 2, ahead=0.1, jitter=0.3)
    expected = find_offset(t, z, stamps, seen, 0.5)
    assert find_offset(t, 3.0 * z - 7.0, stamps, seen, 0.5) == pytest.approx(expected, abs=1e-5)


def test_an_offset_beyond_the_search_is_given_as_its_limit():
    altitude = make_altitude(6)
    ins, stations = see(altitude, 50.0, 1), see(altitude, 1.0, 2, ahead=0.8)
    assert find_offset(*ins, *stations, 0.5) == pytest.approx(0.5, abs=1e-5)
