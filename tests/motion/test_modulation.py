"""An amplitude that grows and falls: exact derivatives, a factor that stays positive."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.departing import AT_ONCE, ModulatedSource, Modulation
from owtsweep.motion.source import Motion, Source, SpectralSource, translated
from owtsweep.streams import stream

STEP = 0.01
POINTS = [[100.0, 0.1], [250.0, 10.0], [300.0, 3.0], [600.0, 0.3]]


def draw(source: Source, steps: int, history: int = 0) -> Motion:
    streams = partial(stream, 1, "test", (4.0,), 0)
    return source.realise(streams, steps=steps, step=STEP, history=history)


def plain() -> SpectralSource:
    return SpectralSource(translated(4.0, 2.4e-4), (0.05, 0.6))


def test_velocity_and_acceleration_are_the_derivatives_of_the_enveloped_position() -> None:
    steps = AT_ONCE + 5000  # across the border between two parts
    motion = draw(ModulatedSource(plain(), Modulation(POINTS)), steps)
    for series, rate in (
        (motion.position, motion.velocity),
        (motion.velocity, motion.acceleration),
    ):
        central = (series[2:] - series[:-2]) / (2.0 * STEP)
        error = np.abs(central - rate[1:-1])
        knots = np.array([round(time / STEP) - 1 for time, _ in POINTS])
        if rate is motion.acceleration:  # it jumps at the points
            error[knots[:, None] + np.arange(-1, 2)] = 0.0
        assert np.max(error) < 3e-4 * np.max(np.abs(rate))  # (omega step)^2 / 6


def test_the_factor_goes_through_its_points_and_stays_between_them() -> None:
    modulation = Modulation(POINTS)
    times, factors = np.array(POINTS).T
    np.testing.assert_allclose(modulation.factor(times), factors, rtol=1e-12)
    found = modulation.factor(np.linspace(-50.0, 900.0, 5000))
    assert found.min() >= 0.1 * (1 - 1e-12)
    assert found.max() <= 10.0 * (1 + 1e-12)
    np.testing.assert_array_equal(modulation.factor(np.array([-1e4, 99.0])), [found[0]] * 2)
    np.testing.assert_allclose(modulation.factor(np.array([601.0, 1e4])), 0.3, rtol=1e-12)
    for rate in modulation.rates(np.array([-1e4, 98.0, 602.0, 1e4])):
        np.testing.assert_array_equal(rate, 0.0)


def test_tenfold_growth_takes_equal_ratios_in_equal_times() -> None:
    modulation = Modulation([[0.0, 1.0], [100.0, 10.0], [200.0, 100.0], [300.0, 1000.0]])
    found = modulation.factor(np.arange(100.0, 201.0, 10.0))
    np.testing.assert_allclose(found[1:] / found[:-1], 10.0**0.1, rtol=1e-9)


def test_a_factor_of_one_changes_nothing_and_history_is_modulated_too() -> None:
    before = draw(plain(), 500, history=30)
    one = draw(ModulatedSource(plain(), Modulation([[3.0, 1.0]])), 500, history=30)
    two = draw(ModulatedSource(plain(), Modulation([[3.0, 2.0]])), 500, history=30)
    for name in ("position", "velocity", "acceleration", "before"):
        np.testing.assert_array_equal(getattr(one, name), getattr(before, name))
        np.testing.assert_allclose(getattr(two, name), 2.0 * getattr(before, name), rtol=1e-14)


@pytest.mark.parametrize(
    ("points", "told"),
    [
        ([], "there is no point"),
        ([[0.0, 1.0, 2.0]], "is not two finite numbers"),
        ([[0.0, 1.0], [5.0, float("nan")]], "is not two finite numbers"),
        ([[0.0, 1.0], [5.0, 0.0]], "the factor 0 at 5 s is not above zero"),
        ([[0.0, 1.0], [5.0, -2.0]], "the factor -2 at 5 s is not above zero"),
        ([[5.0, 1.0], [5.0, 2.0]], "the time 5 s does not come after 5 s"),
    ],
)
def test_bad_points_are_refused_in_one_line(points: list[list[float]], told: str) -> None:
    with pytest.raises(InputError, match=told) as error:
        Modulation(points, "motion.envelope")
    assert str(error.value).startswith("motion.envelope: ")
    assert "\n" not in str(error.value)
