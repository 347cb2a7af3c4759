"""An IMU that leans with the tower: what it measures, in every engine."""

import numpy as np
from tools import SMALL, configure

from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import observe

TILT = 0.0137  # rad/m, that of Ren's turbine


def test_the_specific_force_is_that_of_a_pendulum_gauge():
    """Turn gravity and acceleration into the leaning frame by hand, for an outward lean."""
    config = configure(*SMALL, f"sensors.imu.tilt={TILT}", "record.duration=20", "sensors.yaw=0.0")
    records = make_records(config, 4.0, [0])
    motion = records.motion[0]
    angle = TILT * motion.position  # rad; the x axis points outwards and down by this angle
    outwards = np.stack([np.cos(angle), np.sin(angle)], axis=1)  # horizontal, down
    felt = np.stack([motion.acceleration, np.full_like(angle, -9.81)], axis=1)  # a - g
    exact = np.sum(felt * outwards, axis=1)
    measured = observe(motion, np.array([1.0, 0.0]), records.sensors).specific_force[:, 0]
    np.testing.assert_allclose(measured, exact, atol=2e-4 * np.abs(exact).max())
