"""HME2 with bounds on its window's states: what they change, and what they do not."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
from dense import whitener
from scipy.optimize import lsq_linear
from tools import Array, Streaming, assert_same, configure, measured, plan_blocks, rows_of

from owtsweep.errors import InputError
from owtsweep.evaluation.loop import run_estimator
from owtsweep.studies import compose
from owtsweep.studies.hub import window
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve, under
from owtsweep.studies.hub.horizon import Horizon, horizon, transition_over
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import Measured, Sensors, sensors
from owtsweep.studies.hub.study import HubStudy
from owtsweep.testing.hub_schemes import check_hub_scheme, example_sensors

pytestmark = pytest.mark.usefixtures("kernels")

AMPLITUDE = 0.7


def with_outlier(config: HubConfig) -> tuple[Measured, Array, Sensors]:
    """Sensor data of which one fix, at 10 s, is metres off; and the true position, (steps, 2)."""
    data, known = measured(config, AMPLITUDE)
    fixes = data.fixes.copy()
    fixes[20] += [3.0, -2.0]
    records = make_records(config, config.grid.natural_period[0], [0])
    truth = AMPLITUDE * np.outer(records.motion[0].position, records.direction)
    return data._replace(fixes=fixes), truth, known


def run(config: HubConfig, data: Measured, known: Sensors, *, fast: bool = True) -> Array:
    scheme = under(resolve("HME2"), config)
    estimator = (scheme.stream if fast else scheme.start)(Known(known, config))
    return run_estimator(estimator, *data, known.fix_interval).state


@pytest.mark.parametrize("arrival", ["none", "mkf"])
def test_a_bias_bound_helps_against_an_outlier(arrival: str) -> None:
    base = ("record.duration=20", f"hme.mhe.arrival={arrival}")
    free = configure(*base, tuning="matched")
    bound = configure(*base, "hme.mhe.constraints.bias=0.1", tuning="matched")
    data, truth, known = with_outlier(free)
    hit = slice(200, 260)
    mse = [
        np.mean(np.sum((run(config, data, known)[hit, :2] - truth[hit]) ** 2, axis=1))
        for config in (free, bound)
    ]
    assert mse[1] < {"none": 0.4, "mkf": 0.9}[arrival] * mse[0]


def test_a_bound_that_nothing_reaches_changes_no_bit() -> None:
    base = ("record.duration=12",)
    far = configure(*base, "hme.mhe.constraints={position: 90, velocity: 90, bias: 9}")
    data, _, known = with_outlier(configure(*base))
    scheme = under(resolve("HME2"), far)
    assert not scheme.linear
    assert scheme.batched == ""
    estimator = scheme.stream(Known(known, far))
    found = run_estimator(estimator, *data, known.fix_interval).state
    assert estimator.solved == 0
    np.testing.assert_array_equal(found, run(configure(*base), data, known))
    reference = run(far, data, known, fast=False)
    assert_same(found, reference, "estimate")


@pytest.mark.parametrize(("arrival", "bound"), [
    ("mkf", "bias=0.1"), ("mkf", "velocity=1"), ("none", "position=0.8"), ("none", "bias=0.3"),
    ("fixed", "bias=0.1"), ("fixed", "position=0.8"),
])  # fmt: skip
def test_the_compiled_form_is_the_reference(arrival: str, bound: str) -> None:
    changes = (f"hme.mhe.arrival={arrival}", f"hme.mhe.constraints.{bound}")
    config = configure("record.duration=13", *changes, tuning="matched")
    data, _, known = with_outlier(config)
    data.fixes[23] = np.nan
    scheme = under(resolve("HME2"), config)
    estimator = scheme.stream(Known(known, config))
    found = run_estimator(estimator, *data, known.fix_interval).state
    assert estimator.solved > 0
    assert_same(found, run(config, data, known, fast=False), "estimate")


@pytest.mark.parametrize("arrival", ["mkf", "none", "fixed"])
def test_the_contract_holds_whatever_the_data(arrival: str) -> None:
    # data of the size of kilometres: nearly every window stands on its bounds
    changes = (f"hme.mhe.arrival={arrival}", "hme.mhe.constraints={velocity: 2, bias: 0.2}")
    config = configure(*changes, tuning="matched")
    scheme = Streaming(under(resolve("HME2"), config))
    check_hub_scheme(scheme, config, example_sensors()[1:])


# --- one window ------------------------------------------------------------------------------


def problem(
    bounds: Array, yaw: float = 0.0, gravity: Array | None = None
) -> tuple[Horizon, Sensors]:
    config = configure("hme.mhe.arrival=none", "hme.mhe.horizon=6", tuning="matched")
    g = (0.0, 0.0) if gravity is None else (float(gravity[0]), float(gravity[1]))
    known = replace(sensors(config.sensors), yaw=yaw, gravity=g)
    return replace(horizon(config.hme.mhe, known), bounds=bounds), known


def window_data() -> tuple[Array, Array]:
    random = np.random.default_rng(4)
    fixes = np.cumsum(random.normal(size=(7, 2)), axis=0)
    effects = random.normal(size=(7, 6)) * [0.5, 0.5, 1.0, 1.0, 0.0, 0.0]
    return fixes, effects


def solution(mhe: Horizon, known: Sensors, fixes: Array, effects: Array) -> Array:
    return window.solve(
        mhe, known, solver="qrqp", since_fix=3, fixes=fixes, have=np.ones(7, dtype=bool),
        effects=effects, past=None,
    )  # fmt: skip


@pytest.mark.parametrize("bounds", [
    [np.inf, np.inf, 0.05], [1.5, np.inf, np.inf], [np.inf, 0.7, np.inf], [2.0, 1.2, 0.1],
])  # fmt: skip
def test_the_window_is_the_bounded_least_squares_solution(bounds: list[float]) -> None:
    mhe, known = problem(np.array(bounds))
    fixes, effects = window_data()
    found = solution(mhe, known, fixes, effects)
    half = whitener(mhe.weights.link_covariance)
    A, A_f = mhe.weights.transition, transition_over(3 * known.step)
    sigma = np.sqrt(mhe.weights.fix_variance)
    for axis in range(2):
        J, y = np.zeros((7 + 21, 24)), np.zeros(28)
        for i in range(7):
            J[i, 3 * i], y[i] = 1.0 / sigma, fixes[i, axis] / sigma
            rows = slice(7 + 3 * i, 10 + 3 * i)
            J[rows, 3 * i : 3 * i + 3] = -half @ (A if i < 6 else A_f)
            J[rows, 3 * i + 3 : 3 * i + 6] = half
            y[rows] = half @ effects[i, axis::2]
        limit = np.tile(bounds, 8)
        expected = lsq_linear(J, y, (-limit, limit), method="bvls", tol=1e-15).x.reshape(8, 3).T
        assert np.any(np.isclose(np.abs(expected), np.array(bounds)[:, None], rtol=1e-9))
        difference = np.max(np.abs(found[axis::2] - expected), axis=1)
        assert np.all(difference <= 1e-7 * np.max(np.abs(expected), axis=1))


def test_the_bias_is_bounded_in_the_frame_of_the_imu() -> None:
    bounds = np.array([np.inf, np.inf, 0.05])
    mhe, level = problem(bounds)
    turned = replace(level, yaw=0.7)
    R = turned.rotation
    fixes, effects = window_data()
    in_ned = fixes @ R.T, (effects.reshape(7, 3, 2) @ R.T).reshape(7, 6)
    expected = R @ solution(mhe, level, fixes, effects).reshape(3, 2, 8)
    found = solution(mhe, turned, *in_ned).reshape(3, 2, 8)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-10)
    assert not np.allclose(found, solution(mhe, level, *in_ned).reshape(3, 2, 8), rtol=1e-3)


def test_gravity_is_no_bias() -> None:
    # x4 = -R b^b + g: with g in the data, the bias that is bounded is what is left of x4 beside it
    bounds, g = np.array([np.inf, np.inf, 0.05]), np.array([0.4, -0.3])
    mhe, tilted = problem(bounds, yaw=0.7, gravity=g)
    fixes, effects = window_data()
    x4 = solution(mhe, tilted, fixes, effects)[4:]
    bias = tilted.rotation.T @ (g[:, None] - x4)
    assert np.max(np.abs(bias)) == pytest.approx(0.05, rel=1e-8)
    assert np.max(np.abs(x4)) > 0.25


# --- in a sweep ------------------------------------------------------------------------------


def test_a_sweep_runs_it_directly_and_says_so(caplog: pytest.LogCaptureFixture) -> None:
    base = ("record.duration=8", "grid.amplitude=[0.1,2.0]")
    bound = configure(*base, "hme.mhe.constraints.bias=1000", "schemes=[MKF,HME2]")
    plain = configure(*base, "evaluation=direct", "schemes=[HME2]")
    labels = [block.label for block in plan_blocks(bound)]
    assert labels == [
        "MKF, natural period 4 s, replicate 0",
        "HME2, natural period 4 s, amplitude 0.1 m, replicate 0",
        "HME2, natural period 4 s, amplitude 2 m, replicate 0",
    ]
    with caplog.at_level(logging.WARNING):
        assert HubStudy().engine(bound).backend(bound) == "loky"
    assert [record.message for record in caplog.records] == [
        "HME2: its constraints leave no kernel that serves all amplitudes; it runs step by step, "
        "amplitude by amplitude"
    ]
    found, expected = rows_of(bound), rows_of(plain)
    for key, row in expected.items():
        assert found[key]["value"] == pytest.approx(row["value"], rel=1e-9), key


@pytest.mark.parametrize(("override", "message"), [
    ("hme.mhe.constraints.bias=0", "hme.mhe.constraints.bias: 0 m/s^2 must be a finite number"),
    ("hme.mhe.constraints.velocity=-1", "hme.mhe.constraints.velocity: -1 m/s must be"),
    ("hme.mhe.constraints.bias=much", "hme.mhe.constraints.bias: 'much' is not a number"),
    ("hme.mhe.constraints.yaw=1", "hme.mhe.constraints.yaw: there is no such key"),
    ("hme.mhe.constraints=0.5", "hme.mhe.constraints"),
])  # fmt: skip
def test_bad_constraints_are_refused(override: str, message: str) -> None:
    with pytest.raises(InputError, match=r"^hme\.mhe\.constraints") as raised:
        compose([override])
    assert str(raised.value).startswith(message)


def test_an_estimator_without_an_answer_goes_no_further(monkeypatch: pytest.MonkeyPatch) -> None:
    # a sample half worked in must not be followed by others as if nothing had happened
    config = configure("record.duration=20", "hme.mhe.constraints.bias=0.1", tuning="matched")
    data, _, known = with_outlier(config)
    estimator = under(resolve("HME2"), config).stream(Known(known, config))

    def fail(*_: object, **__: object) -> Array:
        raise ArithmeticError("the MHE's solver stopped")

    monkeypatch.setattr(window, "solve", fail)
    positions = np.full_like(data.specific_force, np.nan)
    positions[:: known.fix_interval] = data.fixes
    with pytest.raises(ArithmeticError, match="solver stopped, at step"):
        estimator.run(data.specific_force, positions)
    with pytest.raises(ArithmeticError, match="start a new estimator"):
        estimator.update(np.zeros(2))
