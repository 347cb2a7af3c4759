"""Online estimators: as the batch engine where fixes come on time, as the reference where not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dense import Measurement, posterior
from tools import Array, Streaming, assert_same, configure, measured, ned, run_batch

import owtsweep
from owtsweep.evaluation.loop import run_estimator
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.models import FORCE, POSITION, axis_filter
from owtsweep.studies.hub.sensors import Measured, Sensors
from owtsweep.testing import check_scheme

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


def stream(name: str, config: HubConfig, sensors: Sensors) -> Any:
    return resolve(name).stream(Known(sensors, config))


def on_time(data: Measured, sensors: Sensors) -> Array:
    """(steps, 2) positions, NaN between fixes."""
    positions = np.full_like(data.specific_force, np.nan)
    positions[:: sensors.fix_interval] = data.fixes
    return positions


def dropouts(data: Measured, sensors: Sensors) -> Array:
    """As `on_time`, without the first fix, some others, and a gap longer than the MHE's window."""
    positions = on_time(data, sensors)
    fixes = np.arange(len(data.fixes))
    lost = (np.random.default_rng(3).random(len(fixes)) < 0.3) | ((fixes >= 11) & (fixes < 19))
    lost[[0, 1]] = [True, False]
    positions[:: sensors.fix_interval][lost] = np.nan
    return positions


def assert_as_reference(name: str, config: HubConfig, positions: Array, data: Measured,
                        sensors: Sensors, tolerance: float = 1e-9) -> None:  # fmt: skip
    fast = stream(name, config, sensors).run(data.specific_force, positions)
    slow = resolve(name).start(Known(sensors, config))
    steps = len(positions)
    state, covariance, variance = (np.full((steps, *s), np.nan) for s in ((4,), (4, 4), ()))
    for k, (force, fix) in enumerate(zip(data.specific_force, positions, strict=True)):
        estimate = slow.update(force, None if np.isnan(fix[0]) else fix)
        state[k] = *estimate.position, *estimate.velocity
        covariance[k] = estimate.covariance
        if estimate.innovation is not None:
            variance[k] = estimate.innovation.covariance[0, 0]
    assert_same(fast.state, state, "estimate", tolerance)
    deviation = np.sqrt(np.max(np.diagonal(covariance, axis1=1, axis2=2), axis=0))
    difference = np.max(np.abs(np.kron(fast.covariance, np.eye(2)) - covariance), axis=0)
    assert np.all(difference <= 1e-9 * np.outer(deviation, deviation))
    np.testing.assert_allclose(fast.innovation_variance, variance, rtol=1e-9)


@pytest.mark.parametrize("tuning", ["paper", "matched", "printed"])
@pytest.mark.parametrize("name", SCHEMES)
def test_with_every_fix_on_time_it_is_the_batch_result(name: str, tuning: str) -> None:
    config = configure(tuning=tuning)  # 600 steps: the registers are moved to the front many times
    data, sensors = measured(config)
    batch = run_batch(resolve(name), config, data, sensors)
    found = stream(name, config, sensors).run(data.specific_force, on_time(data, sensors))
    assert_same(found.state, batch.state, "estimate")
    np.testing.assert_allclose(
        np.kron(found.covariance, np.eye(2)), batch.reported, rtol=1e-9, atol=1e-15
    )
    have = np.isfinite(batch.innovation_variance)
    np.testing.assert_array_equal(np.isfinite(found.innovation_variance), have)
    assert_same(found.innovation[have], batch.innovation[have], "innovation")


@pytest.mark.parametrize("inputs", ["all", "averaged", "sampled"])
@pytest.mark.parametrize("arrival", ["mkf", "fixed", "none"])
def test_every_arrival_and_input(arrival: str, inputs: str) -> None:
    changes = (f"hme.mhe.arrival={arrival}", f"hme.mhe.inputs={inputs}", "record.duration=8")
    config = configure(*changes, tuning="matched")
    data, sensors = measured(config)
    batch = run_batch(resolve("HME2"), config, data, sensors)
    found = stream("HME2", config, sensors).run(data.specific_force, on_time(data, sensors))
    assert_same(found.state, batch.state, "estimate")


@pytest.mark.parametrize("changes", [
    ("hme.smoother_window=0", "sensors.gnss.delay=0"),
    ("hme.smoother_window=13", "sensors.gnss.delay=0.65"),
    ("hme1.model=sigma2", "hme1.discretisation=first_order"),
    ("hme1.update_rule=mask_columns",),
    ("hme.predictor.hold=first",),
    ("hme.predictor.hold=first", "hme.smoother_window=0", "sensors.gnss.delay=0"),
    ("hme.predictor.hold=first", "hme1.tilt=0.02"),
    ("hme1.update_rule=mask_rows", "hme1.r_gnss.scale=100"),
])  # fmt: skip
def test_windows_delays_models_and_rules(changes: tuple[str, ...]) -> None:
    config = configure("record.duration=8", *changes, tuning="matched")
    data, sensors = measured(config)
    batch = run_batch(resolve("HME1"), config, data, sensors)
    found = stream("HME1", config, sensors).run(data.specific_force, on_time(data, sensors))
    assert_same(found.state, batch.state, "estimate")
    np.testing.assert_allclose(
        np.kron(found.covariance, np.eye(2)), batch.reported, rtol=1e-9, atol=1e-15
    )


@pytest.mark.parametrize("tuning", ["paper", "matched"])
@pytest.mark.parametrize("name", SCHEMES)
def test_missing_fixes(name: str, tuning: str) -> None:
    config = configure("record.duration=15", tuning=tuning)
    data, sensors = measured(config)
    assert_as_reference(name, config, dropouts(data, sensors), data, sensors)


@pytest.mark.parametrize("name", ["HME1", "HME2"])
def test_missing_fixes_and_a_linear_force(name: str) -> None:
    config = configure("record.duration=15", "hme.predictor.hold=first", tuning="matched")
    data, sensors = measured(config)
    assert_as_reference(name, config, dropouts(data, sensors), data, sensors)


@pytest.mark.parametrize("arrival", ["fixed", "none"])
def test_missing_fixes_and_other_arrivals(arrival: str) -> None:
    config = configure("record.duration=15", f"hme.mhe.arrival={arrival}", tuning="matched")
    data, sensors = measured(config)
    assert_as_reference("HME2", config, dropouts(data, sensors), data, sensors)


@pytest.mark.parametrize("name", ["MKF", "HME1"])
def test_filters_take_fixes_at_any_step(name: str) -> None:
    config = configure("record.duration=10", tuning="matched")
    data, sensors = measured(config)
    positions = np.full_like(data.specific_force, np.nan)
    at = np.sort(np.random.default_rng(5).choice(len(positions), 17, replace=False))
    positions[at] = data.fixes[:17]
    assert_as_reference(name, config, positions, data, sensors)


def test_with_missing_fixes_mkf_is_the_least_squares_solution() -> None:
    changes = ("record.duration=3", "sensors.imu.rate=10", "measures.settling_time=1",
               "hme.mhe.smoother_window=null")  # fmt: skip
    config = configure(*changes, tuning="matched")
    data, sensors = measured(config)
    force = ned(data, sensors)[0]
    axis = axis_filter(config.mkf, sensors)
    positions = on_time(data, sensors)
    M = sensors.fix_interval
    for number in (0, 2, 3):
        positions[number * M] = np.nan
    found = stream("MKF", config, sensors).run(data.specific_force, positions)
    for last in (3, 7, 18, len(force) - 1):
        for lane in range(2):
            rows = [
                Measurement(k, POSITION, positions[k, lane], sensors.position_sigma**2)
                for k in range(last + 1)
                if np.isfinite(positions[k, lane])
            ]
            rows += [
                Measurement(k, FORCE, force[k, lane], sensors.force_sigma**2)
                for k in range(last + 1)
            ]
            dense = posterior(axis.model, axis.initial_covariance, np.zeros((last + 1, 1)), rows)
            expected = dense.mean[-1][:2]
            assert np.max(np.abs(found.state[last, [lane, 2 + lane]] - expected)) <= 1e-8 * np.max(
                np.abs(dense.mean)
            )
            np.testing.assert_allclose(
                found.covariance[last], dense.covariance[-1, :, -1][:2, :2], rtol=1e-7, atol=1e-11
            )


@pytest.mark.parametrize("name", SCHEMES)
def test_the_contract(name: str) -> None:
    check_scheme(Streaming(resolve(name)), ["tuning=matched"])


@pytest.mark.parametrize("name", ["HME1", "HME2"])
def test_one_by_one_is_all_at_once(name: str) -> None:
    config = configure("record.duration=10", tuning="matched")
    data, sensors = measured(config)
    positions = dropouts(data, sensors)
    whole = stream(name, config, sensors).run(data.specific_force, positions)
    single = stream(name, config, sensors)
    for k, force in enumerate(data.specific_force):
        fix = None if np.isnan(positions[k, 0]) else positions[k]
        estimate = single.update(force, fix)
        np.testing.assert_array_equal(whole.state[k], [*estimate.position, *estimate.velocity])
        assert (estimate.innovation is None) == np.isnan(whole.innovation_variance[k])


@pytest.mark.parametrize("name", ["MKF", "HME2", "SKFA"])
def test_no_samples_give_no_estimates(name: str) -> None:
    estimator = owtsweep.online(name, origin=(0.0, 0.0))
    assert estimator.run_record(np.zeros((0, 2)), np.zeros((0, 2))).state.shape == (0, 4)


def test_nothing_drifts_and_memory_stays() -> None:
    """After 120 000 steps the estimate is that of one who began 60 000 steps ago."""
    config = configure(tuning="matched")
    sensors = measured(config)[1]
    random = np.random.default_rng(1)
    M, steps, last = sensors.fix_interval, 120_000, 60_000
    estimators = {name: stream(name, config, sensors) for name in ("HME1", "HME2")}
    force = random.normal(size=(steps, 2))
    positions = np.full((steps, 2), np.nan)
    positions[::M] = random.normal(size=(steps // M, 2))
    for name, old in estimators.items():
        size = sum(np.asarray(item).nbytes for item in old._registers)
        for begin in range(0, steps, 30_000):
            part = slice(begin, begin + 30_000)
            found = old.run(force[part], positions[part])
        young = stream(name, config, sensors).run(force[-last:], positions[-last:])
        assert sum(np.asarray(item).nbytes for item in old._registers) == size
        assert_same(found.state[-1000:], young.state[-1000:], name, 1e-9)
        np.testing.assert_allclose(found.covariance[-1], young.covariance[-1], rtol=1e-9)


def test_bad_samples_are_refused_and_leave_the_estimator_as_it_was() -> None:
    config = configure("record.duration=8", tuning="matched")
    data, sensors = measured(config)
    positions = on_time(data, sensors)
    whole = stream("HME2", config, sensors).run(data.specific_force, positions)
    estimator = stream("HME2", config, sensors)
    estimator.run(data.specific_force[:33], positions[:33])
    with pytest.raises(ValueError, match="specific_force: it is not finite at step 33"):
        estimator.update(np.array([0.0, np.nan]))
    with pytest.raises(ValueError, match="both components"):
        estimator.update(np.zeros(2), np.array([np.nan, 1.0]))
    for force, fix in ((0.1, None), ([0.1], None), ([0.1, 0.2, 0.3], None), ([0, 0], [1.0])):
        with pytest.raises(ValueError, match="is not two numbers"):
            estimator.update(force, fix)
    with pytest.raises(ValueError, match=r"shapes are \(1, 2\) and \(2, 2\)"):
        estimator.run([[0.1, 0.2]], np.full((2, 2), np.nan))
    with pytest.raises(ValueError, match=r"step 33.*multiples of 10"):
        estimator.update(np.zeros(2), np.ones(2))
    reference = resolve("HME2").start(Known(sensors, config))
    for k in range(3):
        reference.update(data.specific_force[k], data.fixes[0] if k == 0 else None)
    with pytest.raises(ValueError, match=r"step 3.*multiples of 10"):
        reference.update(np.zeros(2), np.ones(2))
    rest = estimator.run(data.specific_force[33:], positions[33:])
    np.testing.assert_array_equal(rest.state, whole.state[33:])


def test_a_record_with_missing_fixes_runs_in_the_loop() -> None:
    config = configure("record.duration=8", tuning="matched")
    data, sensors = measured(config)
    fixes = data.fixes.copy()
    fixes[[3, 7]] = np.nan
    data = data._replace(fixes=fixes)
    fast = run_estimator(stream("HME1", config, sensors), *data, sensors.fix_interval)
    slow = run_estimator(resolve("HME1").start(Known(sensors, config)), *data, sensors.fix_interval)
    assert_same(fast.state, slow.state, "estimate")
    assert fast.innovation is not None
    assert slow.innovation is not None
    np.testing.assert_allclose(fast.innovation, slow.innovation, rtol=1e-9, atol=1e-12)


def test_the_public_name() -> None:
    estimator = owtsweep.online("HME1", ["tuning=matched", "sensors.imu.rate=50"])
    estimate = estimator.update([0.1, 0.0], [1.0, -1.0])
    assert estimate.covariance is not None
    assert estimate.position.shape == (2,)
    for scheme, overrides in (("HME3", []), ("HME1", ["sensors.imu.rate=-1"])):
        with pytest.raises(owtsweep.InputError):
            owtsweep.online(scheme, overrides)


def test_the_batch_engine_streams_what_has_no_kernel() -> None:
    config = configure("hme.mhe.constraints.bias=1")
    sensors = measured(config)[1]
    scheme = resolve("HME2")
    assert hasattr(scheme.start_for_runs(Known(sensors, config)), "run")
    reference = Known(sensors, configure("engine=reference"))
    assert not hasattr(scheme.start_for_runs(reference), "run")
