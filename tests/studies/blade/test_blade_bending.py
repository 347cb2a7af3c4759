"""The blade that bends: weight, mode, and what stays where it is."""

from __future__ import annotations

import numpy as np
import pytest
from hanging import QUIET, make, score

from owtsweep.gravity import GRAVITY
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, ROOT, UNIT

SAG = "motion.bending.sag=0.07"
TIMES = np.linspace(0.0, 99.0, 400)


def find_shift(motion, rigid, points):
    """Return by what points are off the rigid blade, in the body's frame."""
    off = motion.locate(points, TIMES) - rigid.locate(points, TIMES)
    frame = rigid.locate(np.vstack([np.zeros(3), np.eye(3)]), TIMES)
    axes = frame[:, 1:] - frame[:, :1]
    return np.einsum("nij,nkj->nki", axes, off)


def test_without_bending_the_blade_is_rigid() -> None:
    assert make()[1].bending is None
    still, bent = make()[1], make(SAG, "motion.bending.vibration=0.01")[1]
    for name in ("root", "unit", "rotation", "specific_force", "rate"):
        assert np.array_equal(getattr(still.truth, name), getattr(bent.truth, name))


def test_weight_bends_by_its_part_across_the_blade() -> None:
    """By brute force: at each sample, the sag along what is felt at the centre of gravity."""
    rigid, bent = make()[1], make(SAG)[1]
    shift = find_shift(bent, rigid, np.vstack([ROOT, UNIT, ANTENNAS[0], PRISMS]))
    assert np.abs(shift[:, :3]).max() < 1e-12
    third = shift[:, 5]
    assert third[:, 2] == pytest.approx(np.full(400, -0.07), abs=1e-3)
    for sample in (0, 1234, 4000):
        time = np.array([0.02 * sample])
        place = np.array([*np.eye(3), np.zeros(3)])
        points = rigid.locate(place, time)[0]
        R = (points[:3] - points[3]).T
        felt = R.T @ (rigid.series.acceleration[sample + rigid.lead, :3] + [0.0, 0.0, GRAVITY])
        off = R.T @ (bent.locate(PRISMS, time) - rigid.locate(PRISMS, time))[0].T
        for k, (x, y, z) in enumerate(PRISMS):
            s = (x + 16.0) / 28.0
            across = -0.07 * felt[1:] / GRAVITY
            along = -2.0 * s / 28.0 * (y * across[0] + z * across[1])
            assert off[:, k] == pytest.approx([along, *(s**2 * across)], abs=1e-8)


def test_the_mode_has_its_size_and_period() -> None:
    words = ("motion.bending.vibration=0.01", "motion.bending.period=1.25")
    rigid, bent = make()[1], make(*words)[1]
    samples = bent.bending(0.02 * np.arange(5000))
    assert np.all(samples[:, 0] == 0.0)
    assert samples[:, 1].std() == pytest.approx(0.01, rel=0.3)
    spectrum = np.abs(np.fft.rfft(samples[:, 1])) ** 2
    assert np.fft.rfftfreq(5000, 0.02)[spectrum.argmax()] == pytest.approx(0.8, rel=0.05)
    assert find_shift(bent, rigid, PRISMS)[:, 1, 2].std() == pytest.approx(
        (20.0 / 28.0) ** 2 * samples[:, 1].std(), rel=0.1
    )


def test_geometry_is_wrong_by_the_sag_and_inertial_units_are_not() -> None:
    for name in ("TOTAL_STATIONS", "GNSS_WAHBA"):
        rigid, bent = (score(name, *QUIET, *words) for words in ((), (SAG,)))
        assert bent["pitch"] > rigid["pitch"] + np.rad2deg(0.07 / 28.0) / 2
    assert score("UKF", SAG) == score("UKF")
