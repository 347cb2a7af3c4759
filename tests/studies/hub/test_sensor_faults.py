"""An AC-coupled accelerometer and a GNSS with a scale error: what they measure, in every engine."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure

from owtsweep.errors import InputError
from owtsweep.motion.source import Motion
from owtsweep.studies import compose
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.error_curves import inputs
from owtsweep.studies.hub.error_spectrum import error_spectrum
from owtsweep.studies.hub.records import Feed, make_records

pytestmark = pytest.mark.usefixtures("kernels")

FAULTY = ("sensors.imu.high_pass=0.004", "sensors.gnss.scale=0.9", "sensors.imu.tilt=0.01")
ALONG = np.array([1.0, 0.0])


def swing(frequency: float, step: float, *, seconds: float, delay: int) -> Motion:
    """A sinusoidal motion of 1 m that was there before the record."""
    omega = 2.0 * np.pi * frequency
    angle = omega * step * np.arange(-delay, round(seconds / step)) + 0.7
    position = np.cos(angle)
    now = slice(delay, None)
    return Motion(
        step,
        position[now],
        -omega * np.sin(angle[now]),
        -(omega**2) * position[now],
        position[:delay],
    )


def test_an_ac_coupling_answers_as_its_transfer_function() -> None:
    sensors = sensing.sensors(configure("sensors.imu.high_pass=0.01").sensors)
    motion = swing(0.25, sensors.step, seconds=60.0, delay=sensors.delay)
    omega, corner = 2.0 * np.pi * 0.25, 2.0 * np.pi * 0.01
    wave = np.exp(1j * (omega * sensors.step * np.arange(len(motion.position)) + 0.7))
    exact = (-(omega**2) * wave / (1.0 + corner / (1j * omega))).real
    felt = sensing.couple(motion, sensors).specific_force
    # from the first step on: the coupling has settled before the record
    assert np.max(np.abs(felt - exact)) < 2.0 * (corner / omega) ** 3 * omega**2
    assert np.max(np.abs(motion.acceleration - exact)) > 0.03 * omega**2


def test_the_error_spectrum_has_the_faults_of_the_sensors() -> None:
    config = configure("sensors.yaw=0", *FAULTY, *(f"{s}.q_b=1e-6" for s in ("mkf", "hme1")))
    sensors = sensing.sensors(config.sensors)
    chain = resolve("HME1").kernel(Known(sensors, config))
    motion = swing(0.37, sensors.step, seconds=600.0, delay=sensors.delay)
    leaning = sensing.lean(motion, sensors.tilt)
    measured = sensing.observe(sensing.couple(leaning, sensors), ALONG, sensors)
    position, _, _ = estimates.trajectories(chain, measured.specific_force, measured.fixes)
    last = slice(-round(100.0 / sensors.step), None)  # whole periods of motion and fixes
    error = np.mean((position[:, 0] - motion.position)[last] ** 2) / 0.5
    of_theory = error_spectrum(chain, sensors, np.array([0.37])).position[0]
    assert error == pytest.approx(of_theory, rel=1e-2)
    assert (
        of_theory
        > 5.0
        * error_spectrum(
            chain, sensing.sensors(configure("sensors.yaw=0").sensors), np.array([0.37])
        ).position[0]
    )


def test_all_ways_to_a_record_hold_the_faults() -> None:
    records = make_records(configure("sensors.yaw=0", *FAULTY), 4.0, [0])
    (motion,) = records.motion
    sensors = records.sensors
    felt = sensing.couple(motion, sensors).specific_force
    assert not np.allclose(motion.specific_force, motion.acceleration, atol=1e-3)
    assert len(felt) == len(motion.acceleration)
    fixes = 0.9 * motion.position_at(-sensors.delay, sensors.fix_interval, 60)
    seen = sensing.observe(motion, records.direction, sensors)
    np.testing.assert_allclose(seen.fixes, fixes[:, None] * records.direction, rtol=1e-12)
    np.testing.assert_allclose(Feed(records).fixes[:, 0], fixes, rtol=1e-12)
    noise = records.measure(0.0)[1]
    np.testing.assert_allclose(
        records.measure(2.0)[1] - noise, 2.0 * seen.fixes, rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(inputs.motion(np.array([0.1]), sensors).fix, [0.9])


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (("sensors.imu.high_pass=0.01", "engine=expected"), "engine=batch"),
        (("sensors.imu.high_pass=10",), "half of the IMU's rate"),
        (("sensors.gnss.scale=0",), r"gnss\.scale"),
    ],
)
def test_faults_that_cannot_work_are_refused(overrides: tuple[str, ...], says: str) -> None:
    with pytest.raises(InputError, match=says):
        configure(*overrides)


@pytest.mark.parametrize("fault", ["sensors.imu.high_pass=0.01", "sensors.gnss.scale=0.9"])
def test_a_replay_refuses_faults_that_it_does_not_simulate(fault: str) -> None:
    with pytest.raises(InputError, match="a replay does not simulate"):
        compose([fault], primary="replay")
