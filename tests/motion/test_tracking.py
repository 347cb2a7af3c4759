"""The tracker finds the spectrum of a motion from the specific force."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.arrays import Array
from owtsweep.motion.candidates import (
    PERIODS,
    VARIANCES,
    Candidate,
    Fixes,
    Force,
    Sea,
    Stretch,
    pick,
)
from owtsweep.motion.source import translated
from owtsweep.motion.tracking import GAIN, MISSED, SpectrumTracker

STEP, SIGMA, BAND = 0.02, 0.15, (0.05, 0.6)
KNOWN = Force(0.1, 2.0 * SIGMA**2 * STEP, 0.0, BAND)


def simulate(
    period: float, bandwidth: float, variance: float, seconds: float, lean: float = 0.0
) -> Array:
    """Return specific force of a motion, sampled directly from its spectrum, plus white noise."""
    rng = np.random.default_rng(3)
    force, _ = swing(rng, period, bandwidth, variance, seconds, lean)
    return force + SIGMA * rng.standard_normal(len(force)) + 0.1


def swing(
    rng: np.random.Generator, period: float, bandwidth: float, variance: float, seconds: float,
    lean: float = 0.0,
) -> tuple[Array, Array]:  # fmt: skip
    """Return specific force and displacement of a motion, sampled directly from its spectrum."""
    count = round(seconds / STEP)
    frequency = np.fft.rfftfreq(2 * count, STEP)
    inside = (frequency > BAND[0]) & (frequency < BAND[1])
    density = np.where(
        inside, translated(period, bandwidth).density(np.maximum(frequency, 1e-9)), 0
    )
    density *= variance / (density.sum() * frequency[1])
    phases = np.exp(2j * np.pi * rng.random(len(frequency)))
    gain = -((2.0 * np.pi * frequency) ** 2) - lean
    lines = np.sqrt(2.0 * density * frequency[1]) * phases * count
    force, displacement = (np.fft.irfft(part)[:count] for part in (lines * gain, lines))
    return force, displacement


def look(tracker: SpectrumTracker, force: Array) -> Sea | None:
    """Return what a tracker makes of the samples of a specific force."""
    return tracker.look(tracker.average(force))


@pytest.mark.parametrize(("period", "bandwidth"), [(3.0, 3e-4), (8.0, 3e-5), (3.0, 3e-3)])
def test_the_motion_is_found_up_to_the_grid_and_chance(period: float, bandwidth: float) -> None:
    force = simulate(period, bandwidth, 0.01, 600.0)
    tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
    found = look(tracker, force[-12000:])
    assert found is not None
    (T, k, variance), *others = (peak.values for peak in found)
    assert sum(values[2] for values in others) < 0.3 * variance
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
        sizes.append(np.nan if found is None else sum(peak.values[2] for peak in found))
    assert np.all(np.isnan(sizes[:2]))
    assert 0.003 < sizes[18] < 0.03
    assert 0.3 < sizes[27] < 3.0  # 80 s after the change


def test_a_sea_stands_until_a_peak_is_clearly_missed_or_one_peak_would_do() -> None:
    averaged = simulate(4.0, 3e-4, 0.01, 60.0).reshape(-1, 5).mean(axis=1)
    stretch = Stretch(averaged, KNOWN)
    (best,) = stretch.size((pick(stretch.try_peaks()),))
    beside, vain = best._replace(period=best.period + 1), Candidate(40, 0, 0)
    far = best._replace(period=best.period - 8)
    for sea, stands in (((beside,), True), ((far,), False), ((best, vain), False)):
        sized = stretch.size(sea)
        assert (stretch.find_missing(sized)[1] < MISSED) == (sea != (far,))
        gain = stretch.compute_log_likelihood(sized) - stretch.try_peaks().max()
        assert len(sea) == 1 or gain < GAIN
        tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
        tracker.chosen = sea
        tracker.look(averaged)
        assert ([peak[:2] for peak in tracker.chosen] == [peak[:2] for peak in sea]) == stands


@pytest.mark.parametrize("with_fixes", [False, True])
def test_the_likelihood_is_that_of_independent_ordinates(with_fixes: bool) -> None:
    """With fixes, it is that of two noisy sights of one motion, ordinate by ordinate."""
    rng = np.random.default_rng(8)
    force, step, noise, lean = rng.standard_normal(400), 0.1, 0.2, 0.05
    values, known = rng.standard_normal(40), Fixes(1.0, 0.2, 0.3, 0.1, 50.0)
    stretch = Stretch(
        force, Force(step, noise, lean, BAND), (values, known) if with_fixes else None
    )
    sea = Candidate(9, 1, 12), Candidate(30, 2, 8)
    others = stretch.compute_log_likelihood((Candidate(4, 0, 3),))

    def compute(sea: Sea) -> float:
        total = 0.0
        for f in np.fft.rfftfreq(400, step)[1:]:
            if not BAND[0] <= f <= BAND[1]:
                continue
            motion, w = sum(density(peak, f) for peak in sea), 2.0 * np.pi * f
            weight = -(w**2 + lean) * np.sin(np.pi * f * step) / (np.pi * f * step)
            seen, noises, weights = [integrate(force, step, 0.5 * step, f)], [noise], [weight]
            if with_fixes and f < 1.0 / known.step - BAND[1]:
                seen.append(integrate(values, known.step, -known.delay, f))
                red = known.red**2 * 4.0 * known.time / (1.0 + (w * known.time) ** 2)
                noises.append(2.0 * known.sigma**2 * known.step + red)
                weights.append(1.0)
            lines, h = np.array(seen), np.array(weights)
            covariance = motion * np.outer(h, h) + np.diag(noises)
            power = 2.0 / (0.375 * 40.0) * (lines.conj() @ np.linalg.solve(covariance, lines)).real
            total -= np.log(np.linalg.det(covariance)) + power
        return total

    if not with_fixes:
        assert stretch.compute_log_likelihood(sea) * 1.5 == pytest.approx(compute(sea), rel=1e-6)
    # both up to the same constant
    difference = compute(sea) - compute((Candidate(4, 0, 3),))
    assert (stretch.compute_log_likelihood(sea) - others) * 1.5 == pytest.approx(difference)
    table = stretch.try_peaks(sea[:1])
    assert table[sea[1]] == pytest.approx(stretch.compute_log_likelihood(sea))
    np.testing.assert_allclose(stretch.try_peaks(sea[:1], sea[1][:2]), table[sea[1][:2]])
    alone = stretch.try_peaks()
    assert alone[sea[0]] == pytest.approx(stretch.compute_log_likelihood(sea[:1]))


def density(peak: Candidate, f: float) -> float:
    """Return the density of a peak at one frequency (Hz), m^2/Hz."""
    period, bandwidth, variance = peak.values
    spectrum, fine = translated(period, bandwidth), np.linspace(*BAND, 100001)
    return float(
        variance * spectrum.density(np.array(f)) / np.trapezoid(spectrum.density(fine), fine)
    )


def integrate(values: Array, step: float, first: float, f: float) -> complex:
    """Return the Fourier integral of samples with a Hann window, at one frequency (Hz)."""
    time = first + step * np.arange(len(values))
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * time / (step * len(values)))
    wave = np.exp(-2j * np.pi * f * time)
    return complex(step * np.sum((values - values.mean()) * window * wave))


def test_the_sizes_are_the_means_that_are_likely() -> None:
    force = simulate(4.0, 3e-4, 0.002, 30.0).reshape(-1, 5).mean(axis=1)
    stretch = Stretch(force, KNOWN)
    sized = stretch.size((Candidate(14, 1, 0),))[0].variance
    likelihood = stretch.try_peaks((), (14, 1))
    assert sized > likelihood.argmax()  # few ordinates: the mean is larger than the likeliest
    weights = np.exp(likelihood - likelihood.max())
    mean = np.sum(weights * VARIANCES) / np.sum(weights)
    assert abs(np.log(VARIANCES[sized] / mean)) < 0.51 * np.log(VARIANCES[1] / VARIANCES[0])


def test_two_peaks_are_found_and_the_one_that_is_missed_is_named() -> None:
    rng = np.random.default_rng(4)
    parts = [swing(rng, period, 3e-4, 0.005, 240.0)[0] for period in (10.0, 3.85)]
    force = sum(parts) + SIGMA * rng.standard_normal(12000)
    tracker = SpectrumTracker(STEP, SIGMA, 0.0, BAND)
    found = look(tracker, force)
    assert found is not None
    periods = sorted(peak.values[0] for peak in found)
    assert periods[0] == pytest.approx(3.85, rel=0.1)
    assert periods[-1] == pytest.approx(10.0, rel=0.2)
    stretch = Stretch(tracker.average(force), KNOWN)
    (period, _), deviations = stretch.find_missing(found[:1])
    assert PERIODS[period] == pytest.approx(found[1].values[0], rel=0.15)
    assert deviations > 3.0
    assert look(tracker, force) == found  # and it stands


def test_fixes_show_a_slow_motion_that_the_imu_hardly_feels() -> None:
    """The noise of the IMU is so large that it alone cannot tell the motion from none."""
    rng, loud = np.random.default_rng(6), 1.5
    force, displacement = swing(rng, 10.0, 3e-4, 0.01, 240.0)
    force = force + loud * rng.standard_normal(len(force))
    delayed = np.concatenate([np.zeros(10), displacement])[: len(displacement)]
    fixes = delayed[::50] + 0.03 * rng.standard_normal(240)
    known = Fixes(1.0, 0.2, 0.03, 0.0, 300.0)
    periods = []
    for given in (None, (fixes, known), (np.where(np.arange(240) == 100, np.nan, fixes), known)):
        tracker = SpectrumTracker(STEP, loud, 0.0, BAND)
        found = tracker.look(tracker.average(force), given)
        assert found is not None
        largest = max(found, key=lambda peak: peak.values[2])
        periods.append(largest.values[0])
    assert periods[1] == pytest.approx(10.0, rel=0.15)
    assert periods[2] == periods[0]  # a lost fix: the IMU alone
    assert periods[0] != pytest.approx(10.0, rel=0.15)
