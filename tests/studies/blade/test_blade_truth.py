"""The blade's truth by differences, and what its sensors say of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hanging import QUIET, make
from scipy.spatial.transform import Rotation

from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Series, interpolate
from owtsweep.studies.blade.cases import draw_start
from owtsweep.studies.blade.contract import ANTENNAS, PRISMS, ROOT, UNIT
from owtsweep.studies.blade.measuring import find_last_outage, find_outages

STEP = 0.02


def differentiate(signal):
    """Return central differences of the fourth order at the inner samples."""
    return (signal[:-4] - 8.0 * signal[1:-3] + 8.0 * signal[3:-1] - signal[4:]) / (12.0 * STEP)


def test_rates_and_forces_are_derivatives_of_the_motion() -> None:
    truth = make()[1].truth
    inner = slice(2, -2)
    for place, velocity in ((truth.root, truth.root_velocity), (truth.unit, truth.unit_velocity)):
        assert differentiate(place) == pytest.approx(velocity[inner], abs=1e-7)
    felt = differentiate(truth.unit_velocity) + np.array([0.0, 0.0, GRAVITY])
    body = np.einsum("nji,nj->ni", truth.rotation[inner], felt)
    assert truth.specific_force[inner] == pytest.approx(body, abs=1e-6)
    W = np.einsum("nji,njk->nik", truth.rotation[inner], differentiate(truth.rotation))
    rate = np.stack([W[:, 2, 1], W[:, 0, 2], W[:, 1, 0]], axis=1)
    assert truth.rate[inner] == pytest.approx(rate, abs=1e-7)


def test_root_and_unit_are_points_of_one_rigid_body() -> None:
    _, motion, _, _ = make()
    truth = motion.truth
    apart = np.einsum("nji,nj->ni", truth.rotation, truth.root - truth.unit)
    assert apart == pytest.approx(np.broadcast_to(ROOT - UNIT, apart.shape), abs=1e-12)
    times = STEP * np.arange(0, 5000, 50)
    points = motion.locate(np.array([ROOT, UNIT]), times)
    assert points[:, 0] == pytest.approx(truth.root[::50], abs=1e-12)
    assert points[:, 1] == pytest.approx(truth.unit[::50], abs=1e-12)


def test_between_samples_the_motion_is_smooth() -> None:
    time = STEP * np.arange(200)
    omega = 2.0
    series = Series(*(part[:, None] for part in (
        np.sin(omega * time), omega * np.cos(omega * time), -(omega**2) * np.sin(omega * time)
    )))  # fmt: skip
    at = np.array([0.003, 0.5 * STEP, 1.2345])
    assert interpolate(series, STEP, 0, at)[:, 0] == pytest.approx(np.sin(omega * at), abs=1e-12)
    assert interpolate(series, STEP, 3, np.array([-9.0]))[0, 0] == 0.0


def test_sizes_are_those_of_the_configuration() -> None:
    words = ("axes=[period,amplitude]", "grid.period=[9]", "grid.amplitude=[0.5]",
             "grid.heading=[2]", "grid.sigma=[0.006]", "grid.outage=[0]")  # fmt: skip
    spread = []
    for replicate in range(6):
        _, motion, _, _ = make(*words, replicate=replicate, short=False)
        spread.append(motion.series.position.std(axis=0))
    u, _, _, heading = np.sqrt(np.mean(np.square(spread), axis=0))[:4]
    assert u == pytest.approx(np.hypot(0.5, 0.1), rel=0.1)
    assert np.rad2deg(heading) == pytest.approx(np.hypot(2.0, 0.2), rel=0.1)
    crossings = np.diff(np.sign(motion.series.position[:, 0] - motion.series.position[:, 0].mean()))
    assert 300.0 / (np.count_nonzero(crossings) / 2.0) == pytest.approx(9.0, rel=0.15)


def test_sensors_say_the_truth_but_for_their_errors() -> None:
    _, motion, measured, _ = make()
    truth, config = motion.truth, make()[0]
    force, rate = measured.specific_force - truth.specific_force, measured.rate - truth.rate
    assert (force - force.mean(axis=0)).std(axis=0) == pytest.approx([0.01] * 3, rel=0.05)
    assert np.abs(force.mean(axis=0)).max() < 0.004
    assert np.rad2deg(rate.std(axis=0)) == pytest.approx([0.001] * 3, rel=0.05)
    assert np.flatnonzero(measured.due).tolist() == list(range(0, 5000, 10))
    error = measured.fixes - motion.locate(ANTENNAS, STEP * np.arange(5000))
    assert np.isnan(error[~measured.due]).all()
    spread = error[measured.due].std(axis=(0, 1))
    assert spread == pytest.approx(0.006 * np.array([1.0, 1.0, config.sensors.vertical]), rel=0.1)
    prisms = measured.prisms - motion.locate(PRISMS, measured.prism_times)
    assert prisms.std() == pytest.approx(0.003, rel=0.1)
    gaps = np.diff(measured.prism_times)
    assert 0.7 <= gaps.min() < 0.8
    assert 1.2 < gaps.max() <= 1.3


def test_noise_outages_and_offset_are_the_same_draws_enlarged() -> None:
    _, motion, one, _ = make()
    two = make("grid.sigma=[0.06]")[2]
    true = motion.locate(ANTENNAS, STEP * np.arange(5000))
    assert two.fixes - true == pytest.approx(10.0 * (one.fixes - true), nan_ok=True, abs=1e-12)
    late = make("grid.offset=[0.3]")[2]
    shown = motion.locate(ANTENNAS, STEP * np.arange(5000) - 0.3)
    noise = (one.fixes - true)[one.due]
    assert (late.fixes - shown)[one.due][2:] == pytest.approx(noise[2:], abs=1e-9)
    out = make("grid.outage=[15]")[2]
    there = np.isfinite(out.fixes[:, 0, 0])
    assert np.array_equal(out.fixes[there], one.fixes[there])
    assert np.array_equal(out.rate, one.rate)
    assert np.array_equal(out.prisms, one.prisms)


def test_the_last_outage_ends_with_the_record() -> None:
    config = make("grid.outage=[15]", "sensors.outage_every=40")[0]
    lost = find_outages(config, 15.0)
    begins, ends = (np.flatnonzero(np.diff(lost.astype(int)) == sign) + 1 for sign in (1, -1))
    assert (STEP * begins).tolist() == pytest.approx([45.0, 85.0], abs=1.5 * STEP)
    assert (STEP * ends).tolist() == pytest.approx([20.0 + 0.0 + 40.0], abs=1.5 * STEP)
    assert lost[-1]
    last = find_last_outage(config, 15.0)
    assert np.flatnonzero(last)[0] == pytest.approx(85.0 / STEP, abs=1)
    assert find_last_outage(config, 0.0).sum() == 40.0 / STEP


def test_the_lever_is_wrong_by_its_size() -> None:
    _, motion, measured, _ = make(*QUIET, "grid.lever=[0.1]")
    true = motion.locate(ANTENNAS, STEP * np.arange(5000))
    error = np.linalg.norm(measured.fixes - true, axis=2)[measured.due]
    assert error[:, 0] == pytest.approx(0.1, abs=1e-5)
    assert error[:, 1:].max() < 1e-5


def test_the_start_is_wrong_by_its_sizes() -> None:
    errors = []
    config, motion, _, setting = make("unit=mems")
    truth = motion.truth
    for replicate in range(60):
        start = draw_start(config, replace(motion, replicate=replicate))
        (position, velocity), rotation = start.pose
        turned = Rotation.from_matrix(rotation.T @ truth.rotation[0]).as_rotvec()
        errors.append([*(position - truth.unit[0]), *(velocity - truth.unit_velocity[0]), *turned])
    sizes = np.sqrt(np.mean(np.square(errors), axis=0))
    tilt, heading = np.deg2rad([0.2, 0.5])
    assert sizes == pytest.approx([0.01] * 6 + [tilt, tilt, heading], rel=0.3)
    assert setting.start_sigma == pytest.approx([0.01, 0.01, tilt, heading])
