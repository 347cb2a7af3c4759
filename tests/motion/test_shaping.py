"""A shaping filter: it has the spectrum that was asked for, and its rows are derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from scipy.signal import freqs, residue

from owtsweep.motion.shaping import ShapingFilter, fit_shaping_filter
from owtsweep.motion.source import translated

FREQUENCY = (np.arange(1200) + 0.5) * 2e-3
INSIDE = (FREQUENCY > 0.05) & (FREQUENCY < 0.6)
DENSITY = np.where(INSIDE, translated(4.0).density(FREQUENCY), 0.0)
#: About what the sensors see, for motion of 1 m.
FLOOR = 1.0 / (1.0 / 2e-2 + (2.0 * np.pi * FREQUENCY) ** 4 / 7e-3)


@pytest.fixture(scope="module")
def fitted() -> ShapingFilter:
    return fit_shaping_filter(FREQUENCY, DENSITY, 8, FLOOR)


def test_a_rational_spectrum_is_found_again() -> None:
    numerator = [1.0, 0.2]
    denominator = np.polymul([1.0, 0.1, 2.0], [1.0, 0.4, 5.0])
    _, transfer = freqs(numerator, denominator, 2.0 * np.pi * FREQUENCY)
    wanted = np.abs(transfer) ** 2 / np.sum(np.abs(transfer) ** 2 * 2e-3)
    found = fit_shaping_filter(FREQUENCY, np.abs(transfer) ** 2, 4, 1e-6)
    assert found.error < 1e-6
    assert found.density(FREQUENCY) == pytest.approx(wanted, rel=2e-3, abs=1e-6)
    _, poles, _ = residue(numerator, denominator)
    ours = np.linalg.eigvals(found.A)
    assert np.sort_complex(ours) == pytest.approx(np.sort_complex(poles), rel=1e-2)


def test_position_velocity_and_acceleration_belong_together(fitted: ShapingFilter) -> None:
    covariance = solve_continuous_lyapunov(fitted.A, -np.outer(fitted.B, fitted.B))
    omega = 2.0 * np.pi * FREQUENCY
    density = fitted.density(FREQUENCY)
    for row, power in ((fitted.position, 0), (fitted.velocity, 2)):
        by_frequency = np.sum(omega**power * density) * 2e-3
        assert row @ covariance @ row == pytest.approx(by_frequency, rel=2e-3)
    assert fitted.position @ covariance @ fitted.position == pytest.approx(1.0, rel=1e-9)
    # no white noise in the position and the velocity: their derivatives are sums of states
    for row, derivative in (
        (fitted.position, fitted.velocity),
        (fitted.velocity, fitted.acceleration),
    ):
        assert abs(row @ fitted.B) < 1e-12 * np.linalg.norm(row)
        assert row @ fitted.A == pytest.approx(derivative, abs=1e-12)
    assert np.all(np.linalg.eigvals(fitted.A).real < 0.0)
    assert np.all(np.abs(np.log(np.diagonal(covariance))) < np.log(10.0))  # well scaled


def test_more_states_come_closer_and_the_error_is_the_divergence(fitted: ShapingFilter) -> None:
    ratio = (DENSITY / np.sum(DENSITY * 2e-3) + FLOOR) / (fitted.density(FREQUENCY) + FLOOR)
    assert fitted.error == pytest.approx(np.sum(ratio - np.log(ratio) - 1.0) * 2e-3)
    fewer = fit_shaping_filter(FREQUENCY, DENSITY, 4, FLOOR)
    more = fit_shaping_filter(FREQUENCY, DENSITY, 12, FLOOR)
    assert 5.0 * more.error < fitted.error < 0.1 * fewer.error


def test_a_fit_does_not_hang_on_the_scale_of_the_density(fitted: ShapingFilter) -> None:
    scaled = fit_shaping_filter(FREQUENCY, 1e-3 * DENSITY, 8, FLOOR)
    np.testing.assert_allclose(scaled.A, fitted.A, rtol=1e-6, atol=1e-6)
