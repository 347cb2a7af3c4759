"""Paced, stretched and two-peaked motions: derivatives, sizes and spectra."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from owtsweep.motion.departing import Modulation, PacedSource, PeakSum, StretchedSource, rescale
from owtsweep.motion.source import Motion, SpectralSource, translated
from owtsweep.streams import stream

STEP, STEPS, BAND = 0.01, 30_000, (0.05, 0.6)
draws = partial(stream, 1, "hub", (), 0)
PLAIN = SpectralSource(translated(5.0), BAND)


def check_derivatives(motion: Motion) -> None:
    """Compare velocity and acceleration with central differences, also at the record's start."""
    whole = np.concatenate([motion.before[-1:], motion.position])
    velocity = (whole[2:] - whole[:-2]) / (2 * STEP)
    acceleration = (whole[2:] - 2 * whole[1:-1] + whole[:-2]) / STEP**2
    scale = np.abs(motion.acceleration).max()
    assert np.abs(velocity - motion.velocity[:-1]).max() < 1e-3 * np.abs(motion.velocity).max()
    assert np.abs(acceleration - motion.acceleration[:-1]).max() < 2e-3 * scale


@pytest.mark.parametrize("factor", [0.9, 1.2])
def test_a_paced_motion_is_one_motion_and_its_derivatives(factor: float) -> None:
    pace = Modulation([[100.0, 1.0], [200.0, factor]])
    motion = PacedSource(PLAIN, pace, "peak").realise(draws, steps=STEPS, step=STEP, history=30)
    assert len(motion.position) == STEPS
    assert len(motion.before) == 30
    assert np.abs(motion.position).max() == pytest.approx(1.0)
    check_derivatives(motion)


def find_frequency(position: np.ndarray) -> float:
    """Return the number of upward zero crossings per second."""
    up = (position[:-1] < 0.0) & (position[1:] >= 0.0)
    return float(up.sum() / (STEP * len(position)))


def test_a_pace_of_one_factor_is_that_motion_at_other_frequencies() -> None:
    fast = PacedSource(PLAIN, Modulation([[0.0, 1.5]]), "rms")
    paced = fast.realise(draws, steps=STEPS, step=STEP, history=7)
    whole = PLAIN.realise(draws, steps=45_003, step=STEP, history=15)
    ratio = whole.position[::3][:1000] / paced.position[::2][:1000]
    assert ratio == pytest.approx(np.full(1000, ratio[0]), rel=1e-4)
    assert np.std(paced.position) == pytest.approx(1.0)


def test_a_drifting_period_ends_shorter() -> None:
    pace = Modulation([[0.0, 1.0], [300.0, 1.0 / 0.8]])
    narrow = SpectralSource(translated(5.0, 1e-7), BAND)
    motion = PacedSource(narrow, pace, "peak").realise(draws, steps=STEPS, step=STEP)
    ends = [find_frequency(part) for part in (motion.position[:6000], motion.position[-6000:])]
    assert ends[1] / ends[0] == pytest.approx(1.25, rel=0.07)


def test_a_stretched_motion_has_its_time_and_its_size_changed() -> None:
    own = PLAIN.realise(draws, steps=STEPS, step=STEP / 2, history=20)
    motion = StretchedSource(PLAIN, 2.0, "peak").realise(draws, steps=STEPS, step=STEP, history=20)
    np.testing.assert_allclose(motion.position, own.position, rtol=1e-12)
    np.testing.assert_allclose(motion.acceleration, own.acceleration / 4, rtol=1e-12)
    check_derivatives(motion)


def test_peaks_share_the_variance() -> None:
    frequency = np.arange(0.05, 0.6, 1e-4)
    peaks = [translated(10.0), translated(1.0 / 0.26)]
    both = PeakSum(tuple(peaks)).density(frequency)
    parts = [peak.density(frequency) for peak in peaks]
    assert both.sum() == pytest.approx(2.0)
    np.testing.assert_allclose(both, sum(part / part.sum() for part in parts))


@pytest.mark.parametrize("normalise", ["peak", "rms"])
def test_a_rescaled_motion_has_the_size_of_a_spectrum_s(normalise: str) -> None:
    motion = SpectralSource(translated(5.0), BAND, normalise).realise(draws, steps=999, step=STEP)
    bigger = Motion(STEP, *(3.0 * series for series in (
        motion.position, motion.velocity, motion.acceleration, motion.before)))  # fmt: skip
    again = rescale(bigger, normalise)
    np.testing.assert_allclose(again.acceleration, motion.acceleration, rtol=1e-12)
