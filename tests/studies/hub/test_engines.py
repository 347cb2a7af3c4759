"""The batch engine against the reference engine, on every state that they have."""

from __future__ import annotations

import numpy as np
import pytest
from tools import assert_same, configure, measured, plan_blocks, run_batch, run_reference

from owtsweep.studies.hub import batch
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import resolve

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
TUNINGS = ("paper", "matched", "printed")
#: The MHE's window of four fixes is full after 2 s, at a fix per second after 4 s.
SHORT = "record.duration=6"


def assert_engines_agree(name: str, config: HubConfig, tolerance: float = 1e-9) -> None:
    scheme = resolve(name)
    data, sensors = measured(config)
    fast = run_batch(scheme, config, data, sensors)
    slow = run_reference(scheme, config, data, sensors)
    assert_same(fast.state, slow.state, "estimate", tolerance)
    assert_same(fast.filtered, slow.filtered, "filter's state", tolerance)
    for what, ours, reference in (
        ("filter's covariance", fast.covariance, slow.covariance),
        ("reported covariance", fast.reported, slow.reported),
    ):
        deviation = np.sqrt(np.max(np.diagonal(reference, axis1=1, axis2=2), axis=0))
        difference = np.max(np.abs(ours - reference), axis=0)
        assert np.all(difference <= 1e-9 * np.outer(deviation, deviation)), what
    have = np.isfinite(slow.innovation_variance)
    np.testing.assert_array_equal(np.isfinite(fast.innovation_variance), have)
    assert_same(fast.innovation[have], slow.innovation[have], "innovation", tolerance)
    np.testing.assert_allclose(
        fast.innovation_variance[have], slow.innovation_variance[have], rtol=1e-9
    )


@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("tuning", TUNINGS)
def test_engines_agree(name: str, tuning: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # 6 s at 20 Hz: the record crosses the border between two chunks
    monkeypatch.setattr(batch, "CHUNK", 50)
    config = configure(SHORT, tuning=tuning)
    assert config.record.duration * config.sensors.imu.rate > 2 * batch.CHUNK
    assert config.sensors.yaw != 0.0
    assert_engines_agree(name, config)


@pytest.mark.parametrize("arrival", ["mkf", "fixed", "none"])
@pytest.mark.parametrize("tuning", TUNINGS)
def test_arrival_terms(arrival: str, tuning: str) -> None:
    # 10 Hz: the transient of the gains, which the arrival term follows, has half as many rows
    changes = ("sensors.imu.rate=10", f"hme.mhe.arrival={arrival}")
    assert_engines_agree("HME2", configure(SHORT, *changes, tuning=tuning))


@pytest.mark.parametrize("rule", ["proper", "mask_columns", "mask_rows", "every_step"])
@pytest.mark.parametrize("model", ["sigma1", "sigma2"])
@pytest.mark.parametrize(("name", "section"), [("MKF", "mkf"), ("HME1", "hme1")])
def test_models_and_update_rules(name: str, section: str, model: str, rule: str) -> None:
    changes = [f"{section}.model={model}", f"{section}.update_rule={rule}"]
    if rule == "mask_rows":  # with the true variance its covariance is soon negative, and refused
        changes.append(f"{section}.r_gnss.scale=100")
    assert_engines_agree(name, configure(SHORT, *changes, tuning="matched"))


@pytest.mark.parametrize(
    ("weights", "inputs"),
    # tuning=matched itself has the weights "full" and the inputs "all"
    [("diagonal", "all"), ("full", "averaged"), ("full", "sampled"), ("diagonal", "sampled")],
)
def test_horizon_inputs_and_weights(weights: str, inputs: str) -> None:
    changes = (f"hme.mhe.inputs={inputs}", f"hme.mhe.weights={weights}")
    assert_engines_agree("HME2", configure(SHORT, *changes, tuning="matched"))


@pytest.mark.parametrize("name", ["MKF", "HME1", "HME2"])
@pytest.mark.parametrize("delay", [0.0, 0.05, 0.65])
def test_delays(name: str, delay: float) -> None:
    # none, one step, and longer than the .5 s between fixes
    config = configure(SHORT, f"sensors.gnss.delay={delay}", tuning="matched")
    assert_engines_agree(name, config)


OF_BOTH = [
    ("sensors.imu.rate=10", "sensors.gnss.rate=10"),  # a fix with every sample
    ("sensors.gnss.rate=1", "hme.mhe.interval=0.25"),
    ("hme.smoother_window=0",),
    ("hme.smoother_window=13",),  # longer than the fix interval
    ("hme2.model=sigma2", "hme1.model=sigma2", "hme1.discretisation=first_order"),
    ("hme.predictor.hold=first",),
    ("hme.predictor.hold=first", "hme.smoother_window=0", "sensors.gnss.delay=0.05"),
    ("hme.predictor.hold=first", "hme.smoother_window=0", "sensors.gnss.delay=0"),
    ("hme.predictor.hold=first", "hme1.tilt=0.02", "hme2.tilt=0.02"),
]
OF_THE_MHE = [
    ("hme.mhe.interval=0.5",),  # T_m = T_g
    ("hme.mhe.interval=0.05", "hme.mhe.horizon=1"),
    ("hme.mhe.smoother_window=2",),
]


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        *(("HME1", changes) for changes in OF_BOTH),
        *(("HME2", changes) for changes in (*OF_BOTH, *OF_THE_MHE)),
    ],
    ids=str,
)
def test_rates_and_windows(name: str, changes: tuple[str, ...]) -> None:
    assert_engines_agree(name, configure(SHORT, *changes, tuning="matched"))


def test_ipopt_agrees_to_its_own_accuracy() -> None:
    config = configure(SHORT, "hme.mhe.solver=ipopt", tuning="matched")
    assert_engines_agree("HME2", config, tolerance=1e-6)


@pytest.mark.parametrize("name", ["MKF", "HME1", "HME2"])
def test_chunks_do_not_show(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    config = configure()
    data, sensors = measured(config)
    whole = run_batch(resolve(name), config, data, sensors)
    monkeypatch.setattr(batch, "CHUNK", 23)
    parts = run_batch(resolve(name), config, data, sensors)
    assert_same(parts.state, whole.state, "estimate", 1e-12)
    assert_same(parts.innovation[::10], whole.innovation[::10], "innovation", 1e-12)


def test_the_hold_names_the_blocks_of_the_schemes_that_predict() -> None:
    zero, first = (
        {
            block.content["scheme"]: block.content["tuning"]
            for block in plan_blocks(configure(f"hme.predictor.hold={hold}"))
        }
        for hold in ("zero", "first")
    )
    assert [name for name in SCHEMES if zero[name] != first[name]] == ["HME1", "HME2"]
