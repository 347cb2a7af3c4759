"""An IMU that leans with the tower: what it measures, what filters make of it, in every engine."""

import numpy as np
import pytest
from test_engines import assert_engines_agree
from test_online import on_time, stream
from tools import assert_same, compose, configure, measured, run_batch

from experiments.tilt import compare_knowledge
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.kalman import bound_of_axis
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.error_spectrum import error_spectrum
from owtsweep.studies.hub.noise_floor import noise_floor
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import observe

pytestmark = pytest.mark.usefixtures("kernels")

TILT = 0.0137  # rad/m, that of Ren's turbine
FILTERS = ("ekf", "mkf", "hme1", "hme2")


def believed(tilt: float) -> list[str]:
    """Return the overrides by which every filter believes in a tilt (rad/m)."""
    return [f"{name}.tilt={tilt}" for name in FILTERS]


def test_the_specific_force_is_that_of_a_leaning_gauge():
    """Turn acceleration and gravity into the leaning frame by hand, for an outward lean."""
    config = configure(f"sensors.imu.tilt={TILT}", "record.duration=20", "sensors.yaw=0.0")
    records = make_records(config, 4.0, [0])
    motion = records.motion[0]
    angle = TILT * motion.position  # rad; the x axis points outwards and down by this angle
    axis = np.stack([np.cos(angle), np.sin(angle)], axis=1)  # horizontal, down
    felt = np.stack([motion.acceleration, np.full_like(angle, -9.81)], axis=1)  # a - g
    exact = np.sum(felt * axis, axis=1)
    found = observe(motion, np.array([1.0, 0.0]), records.sensors).specific_force[:, 0]
    np.testing.assert_allclose(found, exact, atol=2e-4 * np.abs(exact).max())


@pytest.mark.parametrize("tilt", [0.05, -0.05])
@pytest.mark.parametrize("model", ["sigma1", "sigma2"])
@pytest.mark.parametrize("name", ["EKF", "HME1", "HME2"])
def test_engines_agree(name: str, model: str, tilt: float) -> None:
    changes = [f"{filter}.model={model}" for filter in FILTERS]
    config = configure(
        "record.duration=8", f"sensors.imu.tilt={tilt}", *believed(tilt), *changes, tuning="matched"
    )
    assert_engines_agree(name, config)
    data, sensors = measured(config)
    batch = run_batch(resolve(name), config, data, sensors)
    online = stream(name, config, sensors).run(data.specific_force, on_time(data, sensors))
    assert_same(online.state, batch.state, "estimate")


@pytest.mark.parametrize("inputs", ["averaged", "sampled"])
def test_the_mhe_leans_with_every_kind_of_input(inputs: str) -> None:
    config = configure(
        "record.duration=8", "sensors.imu.tilt=0.05", *believed(0.05),
        f"hme.mhe.inputs={inputs}", "hme2.model=sigma2", "sensors.imu.rate=10",
        tuning="matched",
    )  # fmt: skip
    assert_engines_agree("HME2", config)


@pytest.mark.parametrize("tilt", [TILT, -TILT])
def test_who_knows_the_tilt_is_at_the_kalman_bound(tilt: float) -> None:
    """HME1 of tuning=matched, which is told the tilt, at motions of up to 3 m."""
    config = compose(["tuning=matched", f"sensors.imu.tilt={tilt}", "sensors.imu.bias_walk=1e-3"])
    sensors = sensing.sensors(config.sensors)
    position, velocity = (2.0 * bound for bound in bound_of_axis(sensors))
    if tilt > 0.0:
        assert position == pytest.approx(3.09e-3, rel=0.01)  # 2.59e-3 on a level IMU
    chain = resolve("HME1").kernel(Known(sensors, config))
    motion = error_spectrum(chain, sensors, np.array([1.0 / 8.01, 1.0 / 3.01]))
    noise, rms = noise_floor(chain, sensors), 3.0 / 3.5
    assert np.all(noise.of("position") + rms**2 * motion.position < 1.05 * position)
    assert np.all(noise.of("velocity") + rms**2 * motion.velocity < 1.05 * velocity)


def test_an_unknown_tilt_costs_what_linear_theory_says() -> None:
    """Feed a steady filter a sinusoid whose force leans, and sum the answer in closed form.

    A filter that runs at the fixes' own time and then predicts: its error e obeys
    e+ = (I - K H)(A e - w), where w is what the lean adds to the state over a step.
    """
    from owtsweep.estimation.discretisation import discretise
    from owtsweep.studies.hub.models import sigma_2

    period, config = 8.0, configure(
        f"sensors.imu.tilt={TILT}", "sensors.imu.rate=50", "sensors.gnss.rate=1",
        "sensors.imu.bias_walk=1e-3", "sensors.gnss.delay=0", "hme.smoother_window=0",
        *(f"{filter}.model=sigma2" for filter in FILTERS), tuning="matched",
    )  # fmt: skip
    sensors = sensing.sensors(config.sensors)
    chain = resolve("MKF").kernel(Known(sensors, config))
    found = error_spectrum(chain, sensors, np.array([1.0 / period])).position[0]

    model = discretise(sigma_2(0.0, sensors.bias_walk**2), sensors.step)
    A, B, M = model.A, model.B[:, 0], sensors.fix_interval
    Q = model.Q + sensors.force_sigma**2 * np.outer(B, B)
    P, H = np.eye(3), np.array([1.0, 0.0, 0.0])
    for _ in range(400):  # Riccati's equation over many fixes
        for _ in range(M):
            P = A @ P @ A.T + Q
        K = P @ H / (P[0, 0] + sensors.position_sigma**2)
        P = P - np.outer(K, H @ P)
    omega = 2.0 * np.pi / period
    turn = np.exp(1j * omega * sensors.step)
    lean = -9.81 * TILT  # the force that the filter takes for an acceleration, per metre
    # error just after a fix: E; over M steps it becomes A^M E + sum A^(M-1-j) B lean turn^j
    forced = sum(np.linalg.matrix_power(A, M - 1 - j) @ B * lean * turn**j for j in range(M))
    F = np.eye(3) - np.outer(K, H)
    start = np.linalg.solve(turn**M * np.eye(3) - F @ np.linalg.matrix_power(A, M), F @ forced)
    error, total = start.astype(complex), 0.0
    for j in range(M):
        total += abs(error[0]) ** 2
        error = A @ error + B * lean * turn**j
    assert found == pytest.approx(total / M, rel=0.05)


def test_a_tilt_that_no_filter_can_follow_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    compose(["sensors.imu.tilt=0.6"])  # sqrt(5.9) * 1.2 s = 2.9
    assert "sensors.imu.tilt" not in caplog.text
    compose(["sensors.imu.tilt=0.7"])
    assert "sensors.imu.tilt: 0.7 rad/m lets an error grow exp(3.1) times" in caplog.text


def test_what_knowing_a_tilt_gives_back() -> None:
    """An unknown tilt costs more at long periods and large motions; 20 % is nearly enough."""
    config = compose(["tuning=matched", "schemes=[HME1]"])
    costs = compare_knowledge(config, TILT, [4.0, 8.0], [0.5, 2.0])
    costs = costs.set_index(["knowledge", "amplitude", "natural_period"])["mse_position"]
    assert costs["unknown", 2.0, 8.0] > 5.0 * costs["level", 2.0, 8.0]
    assert costs["20 % too large", 2.0, 8.0] < 1.25 * costs["known", 2.0, 8.0]
    assert costs["unknown", 0.5, 4.0] < costs["known", 0.5, 4.0]  # a known lean is not free
