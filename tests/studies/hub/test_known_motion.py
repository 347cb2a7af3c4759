"""What is known of a motion in advance agrees with records of that motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from experiments.better import roll_off
from owtsweep import InputError
from owtsweep.motion.source import SpectralSource, translated
from owtsweep.studies import compose
from owtsweep.studies.hub.known_motion import find_known_motion
from owtsweep.studies.hub.known_motion import find_noise_density as find_noise
from owtsweep.studies.hub.sensors import sensors

SHORT = "record.duration=200"


def test_variances_are_those_of_records() -> None:
    config = compose([SHORT, "wave_direction=60"])
    known = find_known_motion(config, 4.0, 2.0)
    source = SpectralSource(translated(4.0), (0.05, 0.6))
    records = [
        source.realise(lambda _, seed=seed: np.random.default_rng(seed), steps=2000, step=0.1)
        for seed in range(200)
    ]
    along = np.mean([np.var(2.0 * record.position) for record in records])
    assert known.variance == pytest.approx([0.25 * along, 0.75 * along], rel=0.03)
    by_rms = find_known_motion(compose([SHORT, "normalise=rms"]), 4.0, 2.0)
    assert by_rms.variance == pytest.approx([3.0, 1.0])


def test_the_density_is_that_of_the_spectrum_in_its_band() -> None:
    band = (0.0703, 0.45)  # edges within an interval
    known = find_known_motion(compose([f"band=[{band[0]},{band[1]}]"]), 4.0, 1.0)
    fine = np.linspace(*band, 200_001)
    weight = translated(4.0).density(fine) / translated(4.0).density(fine).sum()
    for lag in (0.0, 0.7, 3.0, 20.0):
        covariance = np.sum(known.density * np.cos(2.0 * np.pi * known.frequency * lag))
        wanted = np.sum(weight * np.cos(2.0 * np.pi * fine * lag))
        assert covariance * known.spacing == pytest.approx(wanted, abs=2e-3)
    first = int(band[0] / known.spacing)  # the interval in which the band begins
    assert np.all(known.density[:first] == 0.0)
    share = (first + 1) - band[0] / known.spacing
    assert 0.3 < share < 0.9
    assert known.density[first] / known.density[first + 1] == pytest.approx(share, rel=0.1)


def test_a_spectrum_may_roll_off_instead() -> None:
    config: Any = compose([])
    hard = find_known_motion(config, 4.0, 1.0)
    soft = roll_off(config, 4.0, hard)
    inside = (hard.frequency > 0.051) & (hard.frequency < 0.599)
    ratio = soft.density[: len(inside)][inside] / hard.density[inside]
    assert ratio == pytest.approx(np.full(inside.sum(), ratio[0]), rel=5e-3)
    above = (soft.frequency > 0.605) & (soft.frequency < 0.9)
    slope = np.diff(np.log(soft.density[above])) / np.diff(np.log(soft.frequency[above]))
    assert slope == pytest.approx(np.full(above.sum() - 1, -4.0), abs=0.1)


def test_the_noise_of_two_sensors_is_below_that_of_each() -> None:
    known = sensors(compose([]).sensors)
    slow, fast = find_noise(known, np.array([1e-3, 2.0]))
    assert slow == pytest.approx(2.0 * 0.03**2, rel=1e-3)
    assert fast == pytest.approx(2.0 * 0.15**2 * 0.01 / (4.0 * np.pi) ** 4, rel=1e-3)


def test_the_motion_of_a_plant_is_not_known() -> None:
    with pytest.raises(InputError, match=r"needs the spectrum .* leave out motion=plant"):
        find_known_motion(compose(["motion=plant"]), 4.0, 1.0)
