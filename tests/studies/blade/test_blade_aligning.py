"""How a recorded lift begins, against a blade that is known exactly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY
from owtsweep.studies.blade.aligning import align
from owtsweep.studies.blade.recorded import Recorded

STEP = 0.02
POSITION, VELOCITY = np.array([3.0, -2.0, 1.0]), np.array([0.2, -0.1, 0.05])
HEADING = 25.0
#: Clockwise seen from above is negative about z; the tilt is about the blade's own axes.
ATTITUDE = Rotation.from_euler("ZYX", [-HEADING, 4.0, -3.0], degrees=True).as_matrix()


def _record(files: int, **known: object) -> tuple[Recorded, Array, Array]:
    """Return the section, specific force and fixes at 5 Hz of a blade that drifts, untwisted."""
    names = [f"gnss{k}.csv" for k in range(files)]
    recorded = Recorded(imu="imu.csv", gnss=names, **known)
    steps = 600
    moved = POSITION + VELOCITY * STEP * np.arange(steps)[:, None]
    fixes = moved[:, None] + recorded.geometry.levers @ ATTITUDE.T
    fixes[np.arange(steps) % 10 > 0] = np.nan
    return recorded, np.tile(GRAVITY * ATTITUDE[2], (steps, 1)), fixes


@pytest.mark.parametrize(
    ("files", "known"),
    [
        (1, {"heading": HEADING}),
        (2, {}),
        (
            1,
            {"attitude": Rotation.from_matrix(ATTITUDE).as_quat(scalar_first=True).tolist()},
        ),
    ],
)
def test_position_velocity_and_attitude_come_out(files: int, known: dict[str, object]) -> None:
    (point, rotation), sigma, _ = align(*_record(files, **known), STEP)
    np.testing.assert_allclose(rotation, ATTITUDE, atol=1e-9)
    np.testing.assert_allclose(point, [POSITION, VELOCITY], atol=1e-9)
    assert np.all(sigma > 0.0)


def test_a_wrong_height_of_an_antenna_does_not_tilt_the_blade() -> None:
    recorded, force, fixes = _record(2)
    fixes[:, 1, 2] += 0.5
    (_, rotation), *_ = align(recorded, force, fixes, STEP)
    np.testing.assert_allclose(rotation[2], ATTITUDE[2], atol=1e-9)
