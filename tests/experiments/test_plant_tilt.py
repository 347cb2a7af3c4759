"""The parts of an error under a tilt are parts of it."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.plant_tilt import make_records, run_hme1


@pytest.mark.usefixtures("kernels")
def test_the_rest_is_at_most_what_motion_and_noise_leave_room_for() -> None:
    records = make_records(["grid.replicates=1", "record.duration=60"], 2.0, 6.0)
    found = run_hme1(records, 0.01)
    rest = found["mse"] - found["motion"] - found["noise"]
    # Cauchy and Schwarz: the mean of a product is at most the root of the product of mean squares
    assert abs(rest) <= 2.0 * np.sqrt(found["motion"] * found["noise"])
    assert found["noise"] > found["motion"] > 0.0
