"""Online estimators in map coordinates: the origin is stated, or the first fix."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import stats
from tools import Array, assert_same, configure, measured, run_batch, whole_series

import owtsweep
from owtsweep.studies import compose
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.online.coordinates import check_origin
from owtsweep.studies.hub.records import Records, make_records

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
#: Northing and easting of a place in UTM, m.
MAP = np.array([6123456.0, 512345.0])


def start(name: str, config: HubConfig, origin: Any) -> Any:
    return resolve(name).stream(Known(measured(config)[1], config), origin=origin)


def record(config: HubConfig) -> tuple[Array, Array]:
    """Specific force, and fixes in map coordinates at the steps at which they come."""
    data, sensors = measured(config)
    positions = np.full_like(data.specific_force, np.nan)
    positions[:: sensors.fix_interval] = data.fixes + MAP
    return data.specific_force, positions


@pytest.mark.parametrize("name", SCHEMES)
def test_about_a_stated_origin_it_is_the_study(name: str) -> None:
    config = configure("record.duration=10", tuning="matched")
    data, sensors = measured(config)
    batch = run_batch(resolve(name), config, data, sensors)
    force, positions = record(config)
    local = positions.copy()
    local[:: sensors.fix_interval] = data.fixes
    found = start(name, config, (0, 0)).run(force, local)
    assert_same(found.state, batch.state, "estimate")
    np.testing.assert_allclose(np.kron(found.covariance, np.eye(2)), batch.reported, rtol=1e-9)
    # at 6 million metres doubles resolve 1e-9 m, and a filter's velocity is that over a second
    found = start(name, config, MAP).run(force, positions)
    np.testing.assert_allclose(found.state - [*MAP, 0, 0], batch.state, rtol=0, atol=1e-8)
    np.testing.assert_allclose(np.kron(found.covariance, np.eye(2)), batch.reported, rtol=1e-9)


@pytest.mark.parametrize("name", SCHEMES)
def test_the_first_fix_is_the_origin_unless_one_is_stated(name: str) -> None:
    config = configure("record.duration=10", tuning="matched")
    force, positions = record(config)
    whole, first = start(name, config, None), start(name, config, positions[0])
    assert whole.origin is None
    np.testing.assert_array_equal(
        whole.run(force, positions).state, first.run(force, positions).state
    )
    np.testing.assert_array_equal(whole.origin, positions[0])


@pytest.mark.parametrize("name", ["MKF", "HME2"])
def test_until_the_first_fix_nothing_is_known(name: str) -> None:
    """The estimator starts with the first fix, wherever that comes, and whatever comes before."""
    config = configure("record.duration=10", tuning="matched")
    force, positions = record(config)
    before = 7  # HME2 counts its steps from the first fix: 7 is no multiple of its 10
    found = start(name, config, None)
    samples = np.vstack([np.ones((before, 2)), force])
    fixes = np.vstack([np.full((before, 2), np.nan), positions])
    parts = [found.run(samples[a:b], fixes[a:b]) for a, b in ((0, 3), (3, 40), (40, 207))]
    state = np.concatenate([part.state for part in parts])
    covariance = np.concatenate([part.covariance for part in parts])
    assert np.isnan(state[:before]).all()
    assert np.isinf(covariance[:before, [0, 1], [0, 1]]).all()
    expected = start(name, config, None).run(force, positions)
    np.testing.assert_array_equal(state[before:], expected.state)
    np.testing.assert_array_equal(covariance[before:], expected.covariance)
    single = start(name, config, None)
    estimate = single.update([1.0, 1.0])
    assert np.isnan([*estimate.position, *estimate.velocity]).all()
    assert np.isinf(np.diagonal(estimate.covariance)).all()
    assert estimate.innovation is None
    with pytest.raises(ValueError, match="not finite at step 1"):
        single.update([np.nan, 0.0])
    assert np.isfinite(single.update(force[0], positions[0]).position).all()


def test_hme2_counts_from_the_first_fix() -> None:
    estimator = start("HME2", configure(tuning="matched"), None)
    estimator.run(np.zeros((7, 2)), np.full((7, 2), np.nan))
    estimator.update([0.0, 0.0], MAP)
    estimator.run(np.zeros((2, 2)), np.full((2, 2), np.nan))
    with pytest.raises(ValueError, match=r"at step 10, .*10 IMU steps after the first one, at ste"):
        estimator.update([0.0, 0.0], MAP)


def test_constraints_are_about_the_origin() -> None:
    config = configure("record.duration=10", "hme.mhe.constraints.position=0.2", tuning="matched")
    force, positions = record(config)
    about_map, about_zero = start("HME2", config, MAP), start("HME2", config, (0, 0))
    found, expected = about_map.run(force, positions), about_zero.run(force, positions - MAP)
    assert about_map.solved == about_zero.solved > 0
    np.testing.assert_allclose(found.state - [*MAP, 0, 0], expected.state, atol=1e-7)


def test_an_origin_that_cannot_be_meant_is_refused() -> None:
    for origin in ("here", [1.0], (0.0, np.nan), 5):
        with pytest.raises(owtsweep.InputError, match=r"origin: .* is not two finite numbers"):
            check_origin(origin)
    estimator = owtsweep.online("HME1", origin=(0, 0))
    with pytest.raises(ValueError, match=r"first fix lies 6.14485e\+06 m from the origin \(0, 0\)"):
        estimator.update([0.0, 0.0], MAP)
    estimator.update([0.0, 0.0], [0.1, 0.2])  # the estimator was left unchanged
    np.testing.assert_array_equal(estimator.origin, [0.0, 0.0])


@cache
def records(delay: float) -> tuple[HubConfig, Records]:
    """20 records of the study's sensors at a natural period of 4 s, 40 s each."""
    config = compose(["experiment=study", "tuning=matched", "record.duration=40",
                      f"sensors.gnss.delay={delay}"])  # fmt: skip
    assert isinstance(config, HubConfig)
    return config, make_records(config, 4.0, range(20))


def sampled_nees(name: str, delay: float, origin: Any, steps: tuple[int, ...]) -> Array:
    """NEES of position and velocity along an axis at some steps, (steps, 2 x records)."""
    config, drawn = records(delay)
    sensors, at, nees = drawn.sensors, np.array(steps), []
    for i, motion in enumerate(drawn.motion):
        force, fixes = whole_series(drawn, 0.2, i)
        positions = np.full_like(force, np.nan)
        positions[:: sensors.fix_interval] = fixes + MAP
        out = resolve(name).stream(Known(sensors, config), origin=origin).run(force, positions)
        along = np.stack([motion.position, motion.velocity], axis=1)[at]
        truth = 0.2 * along[:, :, None] * drawn.direction + [[*MAP], [0.0, 0.0]]
        error = out.state[at].reshape(-1, 2, 2) - truth
        nees.append(np.sum(error * np.linalg.solve(out.covariance[at], error), axis=1))
    return np.concatenate(nees, axis=1)


@pytest.mark.parametrize("origin", [tuple(MAP), None], ids=["stated", "first fix"])
@pytest.mark.parametrize(("name", "delay"), [("HME1", 0.2), ("MKF", 0.0), ("EKF", 0.0)])
def test_stated_deviations_are_true_in_map_coordinates(
    name: str, delay: float, origin: Any
) -> None:
    steps = (0, 40, 99, 201, 503, 2003, 2707, 3411)
    nees = sampled_nees(name, delay, origin, steps)
    settled = nees[5:]
    low, high = stats.chi2.interval(0.999, 2 * settled.size)
    assert low < np.sum(settled) < high
    # at the start the study's first velocity is uncertain by 1 m/s: nothing may be too small
    for early in nees[:5]:
        assert np.sum(early) < stats.chi2.ppf(0.999, 2 * early.size)


@pytest.mark.parametrize("name", ["EKF", "MKF"])
def test_the_noise_of_the_first_fix_is_the_uncertainty_of_the_position(name: str) -> None:
    """A fix as uncertain as the study's first position, 1 m, counts in full nevertheless."""
    config = configure("sensors.gnss.sigma=1.0", tuning="matched")
    estimate = start(name, config, None).update([0.0, 0.0], MAP)
    assert 0.99 <= estimate.covariance[0, 0] <= 1.0
    about_stated = start(name, config, MAP).update([0.0, 0.0], MAP)
    assert about_stated.covariance[0, 0] == pytest.approx(0.5, rel=0.01)
