"""The tracker finds the spectrum of a motion from the specific force."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.arrays import Array
from owtsweep.motion.spectra import translated
from owtsweep.motion.tracking import (
    GAIN_OF_SHAPE,
    Candidate,
    SpectrumTracker,
    compute_log_likelihood,
)

STEP, SIGMA, BAND = 0.02, 0.15, (0.05, 0.6)


def simulate(
    period: float, bandwidth: float, variance: float, seconds: float, lean: float = 0.0
) -> Array:
    """Return specific force of a motion, sampled directly from its spectrum, plus white noise."""
    rng = np.random.default_rng(3)
    count = round(seconds / STEP)
    frequency = np.fft.rfftfreq(2 * count, STEP)
    inside = (frequency > BAND[0]) & (frequency < BAND[1])
    density = np.where(
        inside, translated(period, bandwidth).density(np.maximum(frequency, 1e-9)), 0
    )
    density *= variance / (density.sum() * frequency[1])
    phases = np.exp(2j * np.pi * rng.random(len(frequency)))
    gain = -((2.0 * np.pi * frequency) ** 2) - lean
    lines = np.sqrt(2.0 * density * frequency[1]) * phases * gain * count
    return np.fft.irfft(lines)[:count] + SIGMA * rng.standard_normal(count) + 0.1


def look(tracker: SpectrumTracker, force: Array) -> Candidate | None:
    """Return what a tracker makes of the samples of a specific force."""
    return tracker.look(tracker.average(force))


@pytest.mark.parametrize(("period", "bandwidth"), [(3.0, 3e-4), (8.0, 3e-5), (3.0, 3e-3)])
def test_the_motion_is_found_up_to_the_grid_and_chance(period: float, bandwidth: float) -> None:
    force = simulate(period, bandwidth, 0.01, 600.0)
    tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
    found = look(tracker, force[-12000:])
    assert found is not None
    T, k, variance = found.values
    assert pytest.approx(period, rel=0.12) == T
    assert k == bandwidth
    assert 0.01 / 3.0 < variance < 0.01 * 3.0


def test_a_tilt_that_is_known_does_not_change_what_is_found() -> None:
    lean = 0.3
    leaning = look(SpectrumTracker(STEP, SIGMA, lean, BAND), simulate(6.0, 3e-4, 0.1, 240.0, lean))
    level = look(SpectrumTracker(STEP, SIGMA, 0.0, BAND), simulate(6.0, 3e-4, 0.1, 240.0))
    assert leaning == level


def test_a_sea_that_grows_is_followed_by_the_variance() -> None:
    force = np.concatenate([simulate(4.0, 3e-4, size, 200.0) for size in (0.01, 1.0)])
    tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
    sizes = []
    for seconds in range(10, 401, 10):
        past = force[max(0, round((seconds - 240) / STEP)) : round(seconds / STEP)]
        found = look(tracker, past)
        sizes.append(np.nan if found is None else found.values[2])
    assert np.all(np.isnan(sizes[:2]))
    assert 0.003 < sizes[18] < 0.03
    assert 0.3 < sizes[27] < 3.0  # 80 s after the change


def test_a_choice_stands_until_another_is_clearly_more_likely() -> None:
    force = simulate(4.0, 3e-4, 0.01, 60.0)
    step, noise = 0.1, 2.0 * SIGMA**2 * STEP
    averaged = force.reshape(-1, 5).mean(axis=1)
    likelihood = compute_log_likelihood(averaged, step, noise, 0.0, BAND)
    best = likelihood.max(axis=2)
    # the least likely shape that a tracker may keep, and one that it may not
    close = np.argwhere((best < best.max()) & (best > best.max() - GAIN_OF_SHAPE))[0]
    far = np.argwhere(best < best.max() - GAIN_OF_SHAPE)[0]
    for shape, kept in ((close, True), (far, False)):
        tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
        tracker.chosen = Candidate(*map(int, shape), int(likelihood[tuple(shape)].argmax()))
        tracker.look(averaged)
        assert (tracker.chosen[:2] == tuple(shape)) == kept


def test_the_likelihood_is_that_of_independent_ordinates() -> None:
    rng = np.random.default_rng(8)
    force, step, noise = rng.standard_normal(400), 0.1, 0.2
    whole = compute_log_likelihood(force, step, noise, 0.05, BAND)
    candidate = Candidate(9, 1, 12)
    period, bandwidth, variance = candidate.values
    window = np.hanning(400)
    total = 0.0
    spectrum = translated(period, bandwidth)
    fine = np.linspace(*BAND, 100001)
    area = np.trapezoid(spectrum.density(fine), fine)
    time = step * np.arange(400)
    for f in np.fft.rfftfreq(400, step)[1:]:
        if BAND[0] <= f <= BAND[1]:
            ordinate = np.sum((force - force.mean()) * window * np.exp(-2j * np.pi * f * time))
            periodogram = 2.0 * step * abs(ordinate) ** 2 / np.sum(window**2)
            motion = variance * spectrum.density(f) / area
            weight = ((2 * np.pi * f) ** 2 + 0.05) * np.sin(np.pi * f * step) / (np.pi * f * step)
            model = motion * weight**2 + noise
            total -= np.log(model) + periodogram / model
    assert whole[candidate] * 1.5 == pytest.approx(total, rel=1e-6)
    of_shape = compute_log_likelihood(force, step, noise, 0.05, BAND, candidate[:2])
    np.testing.assert_array_equal(of_shape, whole[candidate[:2]])
