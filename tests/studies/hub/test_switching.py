"""SWITCH: the boundary, the estimated sea, hysteresis, bumpless transfer, and the scheme itself."""

from __future__ import annotations

import numpy as np
import pytest
from tools import Array, assert_same, configure, measured, plan_blocks

import owtsweep
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.evaluation.loop import run_estimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.expected.engine import rows_of
from owtsweep.studies.hub.scheme_sections import Switch
from owtsweep.studies.hub.switching.boundary import (
    ANY,
    NONE,
    Boundary,
    compute_boundary,
    read_boundary,
)
from owtsweep.studies.hub.switching.supervisor import SeaWatch, Supervisor

GROWS = "motion.envelope=[[0,0.05],[15,20],[30,0.05]]"
TABLE = "switch.boundary=[[4,1.0]]"
STEP = 0.05


def watch_sinusoid(watch: SeaWatch, amplitude: float, period: float, offset: float = 0.0) -> None:
    omega = 2.0 * np.pi / period
    for t in STEP * np.arange(6000):
        x, v = amplitude * np.sin(omega * t), amplitude * omega * np.cos(omega * t)
        watch.take(0.6 * x + offset, 0.8 * x - offset, 0.6 * v, 0.8 * v, (0.0, 0.0))


@pytest.mark.parametrize("period", [3.0, 8.0])
def test_amplitude_and_period_of_a_sinusoid_about_an_offset(period: float) -> None:
    watch = SeaWatch(STEP, 60.0, float(np.sqrt(2.0)))
    watch_sinusoid(watch, 0.7, period, offset=5.0)
    assert watch.describe() == pytest.approx((0.7, period), rel=0.02)


def test_the_errors_own_variance_is_not_taken_for_motion() -> None:
    watch = SeaWatch(STEP, 60.0, 3.5)
    random = np.random.default_rng(0)
    noise = random.normal(size=(5000, 4)) * [0.1, 0.1, 0.3, 0.3]
    for row in noise:
        watch.take(*row, (2 * 0.1**2 * 1.2, 2 * 0.3**2))
    amplitude, period = watch.describe()
    assert amplitude == 0.0
    assert np.isnan(period)


def supervise(amplitudes: Array, *, hysteresis: float, blend: float) -> tuple[Array, Supervisor]:
    class Told(SeaWatch):
        now = 0.0

        def describe(self) -> tuple[float, float]:
            return self.now, 4.0

    watch = Told(STEP, 1.0, 1.0)
    edge = Boundary(np.log([2.0, 8.0]), np.log([1.0, 1.0]))
    settings = Switch(hysteresis=hysteresis, memory=1.0, blend=blend)
    supervisor = Supervisor(watch, edge, settings, STEP, every=1)
    weights = []
    for amplitude in amplitudes:
        watch.now = amplitude
        weights.append(supervisor.step(0.0, 0.0, 0.0, 0.0, (0.0, 0.0)))
    return np.array(weights), supervisor


def test_it_switches_at_the_boundary_times_and_divided_by_the_hysteresis() -> None:
    amplitudes = np.concatenate([np.linspace(2.0, 0.1, 500), np.linspace(0.1, 2.0, 500)])
    weights, supervisor = supervise(amplitudes, hysteresis=1.25, blend=0.0)
    down, up = np.flatnonzero(np.diff(weights)) + 1
    assert amplitudes[down - 1] >= 0.8 > amplitudes[down]
    assert amplitudes[up - 1] <= 1.25 < amplitudes[up]
    assert supervisor.switches == 2


def test_an_amplitude_that_swings_inside_the_hysteresis_switches_nothing() -> None:
    amplitudes = 1.0 + 0.15 * np.sin(np.arange(2000))
    assert supervise(amplitudes, hysteresis=1.25, blend=0.0)[1].switches == 0
    assert supervise(amplitudes, hysteresis=1.0, blend=0.0)[1].switches > 100


def test_the_weight_moves_at_a_constant_rate() -> None:
    weights, _ = supervise(np.repeat([2.0, 0.1, 2.0], 300), hysteresis=1.2, blend=5.0)
    assert np.max(np.abs(np.diff(weights))) <= STEP / 5.0 * (1 + 1e-12)
    assert weights.min() == 0.0
    assert weights[[0, -1]].tolist() == [1.0, 1.0]


@pytest.mark.usefixtures("kernels")
def test_the_computed_boundary_is_where_the_expected_maps_meet() -> None:
    config = configure(
        "engine=expected",
        "normalise=rms",
        "record.duration=200",
        "measures.settling_time=50",
        "spectrum.bandwidth=1e-6",  # almost a sinusoid
        "sensors.gravity=[0,0]",
        "sensors.imu.bias_initial=0",
        tuning="matched",
    )
    edge = compute_boundary(config, "MKF", "HME1", 1.0)
    rows = rows_of(changed(config, schemes=["HME1", "MKF"]), ["HME1", "MKF"], [4.0])
    rows = rows[(rows.measure == "position") & (rows.window == "settled")].set_index("scheme")
    amplitude = edge.amplitude(4.0)
    errors = amplitude**2 * rows.motion + rows.noise
    assert errors["HME1"] == pytest.approx(errors["MKF"], rel=0.02)
    assert rows.noise["MKF"] < 0.95 * rows.noise["HME1"]


@pytest.mark.usefixtures("kernels")
def test_a_scheme_that_is_never_worse_is_always_chosen() -> None:
    config = configure("record.duration=60", "measures.settling_time=30", tuning="matched")
    for below, above, amplitude in (("DELTA", "HME1", NONE), ("HME1", "DELTA", ANY)):
        edge = compute_boundary(config, below, above, 1.0)
        np.testing.assert_array_equal(edge.log_amplitude, amplitude)


def test_a_table_is_interpolated_between_logarithms_and_continued() -> None:
    edge = read_boundary([[2.0, 0.1], [8.0, 0.4]])
    assert edge.amplitude(4.0) == pytest.approx(0.2)
    assert edge.amplitude(1.0) == pytest.approx(0.1)
    assert edge.amplitude(50.0) == pytest.approx(0.4)
    assert edge.amplitude(float("nan")) == pytest.approx(0.1)
    assert NONE < ANY


@pytest.mark.usefixtures("kernels")
def test_compiled_and_reference_agree_and_hand_out_one_of_the_two() -> None:
    words = (
        GROWS,
        TABLE,
        "switch.below=MKF",
        "switch.memory=3",
        "switch.blend=1",
        "measures.settling_time=5",
    )
    results = {}
    for engine in ("batch", "reference"):
        config = configure(*words, f"engine={engine}", tuning="paper")
        data, sensors = measured(config)
        known = Known(sensors, config)
        estimators = {
            name: resolve(name).start_for_runs(known) for name in ("HME1", "MKF", "SWITCH")
        }
        results[engine] = {
            name: run_estimator(estimator, *data, sensors.fix_interval)
            for name, estimator in estimators.items()
        }
        if engine == "batch":
            assert estimators["SWITCH"].supervisor.switches >= 2
    fast, slow = (results[engine]["SWITCH"] for engine in ("batch", "reference"))
    assert_same(fast.state, slow.state, "estimate", 1e-9)
    np.testing.assert_allclose(fast.covariance, slow.covariance, rtol=1e-9, atol=1e-15)
    of_one = [
        np.all(slow.state == results["reference"][name].state, axis=1) for name in ("HME1", "MKF")
    ]
    assert np.mean(of_one[0]) > 0.1
    assert np.mean(of_one[1]) > 0.1
    assert np.mean(of_one[0] | of_one[1]) < 1.0  # in between it blends
    assert_nothing_jumps(slow, results["reference"])


def assert_nothing_jumps(blended: Trajectory, alone: dict[str, Trajectory]) -> None:
    """No step of the blend is larger than the larger step of its two, and a share of their gap."""
    steps = {name: np.abs(np.diff(t.state[:, :2], axis=0)) for name, t in alone.items()}
    gap = np.abs(alone["HME1"].state - alone["MKF"].state)[1:, :2]
    largest = np.maximum(steps["HME1"], steps["MKF"]) + gap * STEP / 1.0
    assert np.all(np.abs(np.diff(blended.state[:, :2], axis=0)) <= largest + 1e-12)


def test_its_blocks_depend_on_its_two_schemes_and_its_own_section() -> None:
    def content(*words: str) -> object:
        return plan_blocks(configure("schemes=[SWITCH]", *words))[0].content

    assert content() != content("hme.mhe.horizon=5")
    assert content() != content("switch.memory=20")
    assert content() == content("mkf.q_a=7")
    assert content("switch.below=MKF") != content("switch.below=MKF", "mkf.q_a=7")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("switch.boundary=[[4,0.7],[3,0.5]]",), "switch.boundary: the periods do not rise"),
        (("switch.boundary=[[4]]",), "switch.boundary: [[4.0]] is no list of pairs"),
        (("switch.below=KF",), "switch.below: there is no scheme 'KF'"),
        (("switch.above=SWITCH",), "switch.above: SWITCH cannot switch to itself"),
        (("switch.above=HME2",), "switch.above: HME2 is below the boundary too"),
    ],
)
def test_bad_settings_are_refused_in_one_line(words: tuple[str, ...], told: str) -> None:
    with pytest.raises(InputError) as error:
        configure("schemes=[HME1,SWITCH]", *words)
    assert str(error.value).startswith(told)
    assert "\n" not in str(error.value)


@pytest.mark.usefixtures("kernels")
def test_on_board_it_waits_for_the_first_fix_as_its_two_do() -> None:
    words = ["tuning=paper", TABLE, "switch.below=MKF"]
    estimator = owtsweep.online("SWITCH", words)
    assert np.isnan(estimator.update(np.zeros(2)).position).all()
    found = estimator.update(np.zeros(2), np.array([100.0, -50.0]))
    np.testing.assert_allclose(found.position, [100.0, -50.0], atol=1.0)
