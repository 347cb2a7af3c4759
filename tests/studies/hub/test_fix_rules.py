"""Gates and Huber's weights: what they do to fixes that lie far out, and that the engines agree."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from dense import whitener
from scipy.optimize import minimize
from scipy.stats import chi2
from tools import Array, assert_same, configure, measured

from owtsweep.errors import InputError
from owtsweep.estimation.weighing import ALIKE, Weighing, weigh
from owtsweep.evaluation.loop import run_estimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub import window
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve, under
from owtsweep.studies.hub.models import make_fix_rule
from owtsweep.studies.hub.schemes.hme2 import SCHEME as HME2
from owtsweep.studies.hub.sensors import Measured, Sensors, sensors

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
PATIENCE = "hme1.gate_patience=5", "mkf.gate_patience=5", "ekf.gate_patience=5"
SHORT = ("record.duration=12", "sensors.gnss.outliers.rate=0.2", "sensors.gnss.outliers.size=20")


def ruled(rule: str, *overrides: str) -> HubConfig:
    rules = [f"{section}.fix_rule={rule}" for section in ("ekf", "mkf", "hme1")]
    rules += [f"hme2.fix_rule={'plain' if rule == 'gate' else rule}"]
    return configure(*SHORT, *PATIENCE, *rules, *overrides, tuning="matched")


def run(
    name: str, config: HubConfig, data: Measured, known: Sensors, *, fast: bool = True
) -> Trajectory:
    scheme: Any = under(resolve(name), config)
    estimator = (scheme.stream if fast else scheme.start)(Known(known, config))
    return run_estimator(estimator, *data, known.fix_interval)


@pytest.mark.parametrize(("name", "rule"), [
    ("EKF", "gate"), ("MKF", "gate"), ("HME1", "gate"),
    ("EKF", "huber"), ("MKF", "huber"), ("HME1", "huber"), ("HME2", "huber"),
])  # fmt: skip
def test_the_compiled_form_is_the_reference(name: str, rule: str) -> None:
    config = ruled(
        rule, "hme.mhe.constraints.bias=0.6", "record.duration=5.5", "hme.mhe.interval=0.25"
    )
    data, known = measured(config)
    if name != "HME1":  # whose stated covariance must be that of the weights alone
        data.fixes[7:9] = np.nan
    fast, slow = (run(name, config, data, known, fast=fast) for fast in (True, False))
    assert_same(fast.state, slow.state, "estimate", 1e-7)
    assert fast.covariance is not None
    assert slow.covariance is not None
    late = slice(30, None)  # before, HME's window fills
    np.testing.assert_allclose(fast.covariance[late], slow.covariance[late], rtol=1e-6, atol=1e-12)
    plain = run(name, ruled("plain"), data, known)
    assert np.max(np.abs(plain.state - fast.state)) > 0.05


@pytest.mark.parametrize("name", ["MKF", "HME1"])
def test_a_gate_equals_a_plain_filter_without_the_fixes_that_it_refuses(name: str) -> None:
    config = ruled("gate")
    data, known = measured(config)
    gated = run(name, config, data, known)
    assert gated.innovation is not None
    assert gated.innovation_covariance is not None
    M = known.fix_interval
    e, S = gated.innovation[::M], gated.innovation_covariance[::M, 0, 0]
    far = np.sum(e**2, axis=1) / S > chi2.ppf(0.999, 2)
    refused = far.copy()
    for k in range(5, len(far)):  # the sixth in a row is taken
        refused[k] = far[k] and not far[k - 5 : k].all()
    assert 2 <= refused.sum() < far.sum()
    left = data.fixes.copy()
    left[refused] = np.nan
    plain = run(name, ruled("plain"), data._replace(fixes=left), known)
    np.testing.assert_array_equal(gated.state, plain.state)


def test_a_far_fix_pulls_no_more_than_one_at_the_limit() -> None:
    config = ruled("huber", "sensors.gnss.outliers.rate=0")
    data, known = measured(config)
    moved = []
    for size in (0.0, 1e3, 1e6):
        fixes = data.fixes.copy()
        fixes[12] += size * np.array([0.6, 0.8])
        estimate = run("MKF", config, data._replace(fixes=fixes), known)
        moved.append(estimate.state[12 * known.fix_interval, :2])
    assert estimate.innovation_covariance is not None
    deviation = np.sqrt(estimate.innovation_covariance[12 * known.fix_interval, 0, 0])
    pull = moved[2] - moved[0]
    assert np.linalg.norm(pull) < 2.0 * 2.0 * deviation  # the limit, from either side
    np.testing.assert_allclose(moved[1], moved[2], atol=1e-3 * deviation)


@pytest.mark.parametrize("name", ["MKF", "HME1"])
def test_a_gate_opens_again(name: str) -> None:
    # From 10 s on the fixes are 2 m away: a reference station moved, or the state drifted.
    # (without a delay, which MKF does not know, so that its gate refuses good fixes)
    delay = f"sensors.gnss.delay={0.0 if name == 'MKF' else 0.2}"
    config = ruled("gate", "sensors.gnss.outliers.rate=0", "record.duration=30", delay)
    data, known = measured(config)
    fixes = data.fixes.copy()
    fixes[20:] += 2.0
    shifted = run(name, config, data._replace(fixes=fixes), known)
    straight = run(name, config, data, known)
    assert shifted.innovation is not None
    apart = np.linalg.norm(shifted.state[:, :2] - straight.state[:, :2], axis=1)
    M = known.fix_interval
    assert np.max(apart[20 * M : 24 * M]) < 0.5  # refused at first, five of them
    assert np.max(np.abs(apart[-5 * M :] - np.sqrt(8.0))) < 0.3  # taken in the end
    if name == "MKF":
        assert shifted.innovation_covariance is not None
        variance = shifted.innovation_covariance[20 * M : 27 * M : M, 0, 0]
        assert np.all(np.diff(variance[:6]) > 0.0)  # it grows while fixes are refused
        assert variance[6] < variance[5]


def test_the_window_minimises_hubers_cost() -> None:
    config = ruled("huber", "hme.mhe.arrival=none", "hme.mhe.horizon=6")
    known = sensors(config.sensors)
    mhe = HME2.make_horizon(config, known)
    rng = np.random.default_rng(3)
    fixes = 0.1 * rng.standard_normal((7, 2))
    fixes[[2, 5]] += [[3.0, -2.0], [-1.0, 4.0]]
    effects = 0.01 * rng.standard_normal((6, 6))
    given: dict[str, Any] = {
        "solver": "qrqp", "since_fix": 0, "fixes": fixes, "have": np.ones(7, dtype=bool),
        "effects": effects, "past": None,
    }  # fmt: skip
    found = window.solve(mhe, known, **given)
    least = window.solve(replace(mhe, fix_rule=ALIKE), known, **given)
    U = np.kron(whitener(mhe.weights.link_covariance), np.eye(2))
    A = np.kron(mhe.weights.transition, np.eye(2))

    def cost(x: Array) -> float:
        nodes = x.reshape(6, 7)
        links = U @ (nodes[:, 1:] - A @ nodes[:, :-1] - effects.T)
        far = np.linalg.norm(fixes.T - nodes[:2], axis=0) / np.sqrt(mhe.weights.fix_variance)
        c = mhe.fix_rule.limit
        return float(np.sum(links**2) + np.sum(np.where(far <= c, far**2, 2.0 * c * far - c**2)))

    at = cost(found.ravel())
    assert at < 0.9 * cost(least.ravel())
    assert at <= minimize(cost, found.ravel(), method="Powell", options={"maxiter": 3}).fun + 1e-7
    for _ in range(200):  # convex: no way down from here
        way = rng.standard_normal(42) * np.repeat([1e-4, 1e-4, 1e-4, 1e-4, 1e-5, 1e-5], 7)
        assert cost(found.ravel() + way) > at


def test_the_gate_is_the_chi_square_quantile() -> None:
    rule = make_fix_rule(ruled("gate", "mkf.gate_probability=0.95").mkf)
    assert rule.limit**2 == pytest.approx(chi2.ppf(0.95, 2))
    beyond = np.zeros(1, dtype=np.int64)
    assert [weigh(far, rule, beyond) for far in (2.4, 2.5, 2.4)] == [1.0, 0.0, 1.0]
    assert [weigh(9.0, rule, beyond) for _ in range(7)] == [*[0.0] * 5, 1.0, 1.0]
    assert weigh(8.0, Weighing(2.0, True, 0), beyond) == 0.25


@pytest.mark.parametrize("name", SCHEMES)
def test_a_scheme_whose_fixes_lose_weight_is_not_linear(name: str) -> None:
    scheme = under(resolve(name), ruled("huber"))
    assert not scheme.linear
    assert scheme.batched == ""
    assert under(resolve(name), ruled("plain")).linear
    with pytest.raises(InputError, match="only with fix_rule=plain"):
        ruled("gate", "engine=expected", "sensors.gnss.outliers.rate=0")


def test_a_gate_that_would_stick_is_refused() -> None:
    with pytest.raises(InputError, match=r"^mkf\.fix_rule: a gate sticks with mkf\.update_rule=ev"):
        ruled("gate", "mkf.update_rule=every_step")
    with pytest.raises(InputError, match=r"^hme2\.fix_rule: HME2's filter takes each fix several"):
        ruled("plain", "hme2.fix_rule=gate")
