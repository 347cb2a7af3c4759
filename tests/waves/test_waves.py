"""Waves and their loads against closed forms and raschii's Airy wave."""

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.waves import (
    Cylinder,
    Sea,
    Waves,
    draw_waves,
    find_wave_number,
    inertia_coefficient,
    inertia_force,
)

DEPTH = 30.0


def regular(frequency: float, height: float) -> Waves:
    """Return one regular wave of a frequency (Hz) and a height (m)."""
    number = np.array([1000])
    return Waves(number, 1000 / frequency, np.array([height / 2.0 + 0j]), DEPTH)


def test_a_realisation_has_the_seas_significant_wave_height():
    for hs, tp in ((2.87, 6.03), (2.0, 8.0), (1.0, 4.0)):
        waves = draw_waves(Sea(hs, tp), np.random.default_rng(1), period=4000.0, depth=DEPTH)
        variance = 0.5 * np.sum(np.abs(waves.elevation) ** 2)
        assert 4.0 * np.sqrt(variance) == pytest.approx(hs, rel=0.02)


def test_kinematics_are_those_of_raschii():
    from raschii import AiryWave

    wave = AiryWave(height=2.0, depth=DEPTH, length=60.0)
    ours = regular(wave.omega / (2.0 * np.pi), 2.0)
    assert ours.wave_number[0] == pytest.approx(wave.k, rel=1e-7)
    heights = np.array([-25.0, -10.0, -1.0])
    crest = wave.velocity(np.zeros(3), heights + DEPTH, t=0.0)[:, 0]
    for height, theirs in zip(heights, crest, strict=True):
        assert ours.velocity(height)[0].real == pytest.approx(theirs, rel=1e-7)


def test_dispersion_holds_in_deep_and_shallow_water():
    omega = np.geomspace(1e-3, 30.0, 400)
    k = find_wave_number(omega, DEPTH)
    np.testing.assert_allclose(9.81 * k * np.tanh(k * DEPTH), omega**2, rtol=1e-12)


def test_the_load_of_a_regular_wave_is_the_integral_over_the_depth():
    from owtsweep.motion.plant import _depth_rule

    for frequency in (0.1, 0.258, 0.6):
        waves = regular(frequency, 2.0)
        cylinder = Cylinder(6.0)
        heights, lengths = _depth_rule(DEPTH)
        total = sum(
            length * inertia_force(waves, cylinder, height)[0]
            for height, length in zip(heights, lengths, strict=True)
        )
        k, omega = waves.wave_number[0], waves.omega[0]
        mass = 1025.0 * np.pi / 4.0 * 36.0 * inertia_coefficient(waves.wave_number, 6.0)[0]
        closed = mass * 1j * omega**2 / k  # the integral of cosh k(z + d) / sinh k d is 1 / k
        assert total == pytest.approx(closed, rel=1e-3)


def test_the_inertia_coefficient_is_two_for_long_waves_and_less_for_short_ones():
    k = np.array([1e-4, 0.268])
    long, short = inertia_coefficient(k, 6.0)
    assert long == pytest.approx(2.0, rel=1e-4)
    assert abs(short) == pytest.approx(1.66, rel=0.01)


@pytest.mark.parametrize(
    ("values", "words"),
    [((0.0, 8.0), "hs"), ((2.0, 0.0), "tp"), ((2.0, 60.0), "tp"), ((2.0, 8.0, 0.5), "gamma")],
)
def test_a_sea_that_cannot_be_is_refused(values, words):
    with pytest.raises(InputError, match=words):
        Sea(*values)


def test_a_sea_steeper_than_waves_can_be_says_so():
    assert Sea(3.0, 3.0).breaks
    assert not Sea(2.87, 6.03).breaks
