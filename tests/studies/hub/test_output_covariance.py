"""HME1's reported covariance against the error that every single noise makes in its output."""

from __future__ import annotations

import numpy as np
import pytest
from dense import Measurement, posterior
from tools import configure

from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.models import FORCE, POSITION, axis_filter
from owtsweep.studies.hub.sensors import sensors

LAST = 24


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize(("window", "delay"), [(5, 0.2), (0, 0.3), (3, 0.0)])
@pytest.mark.parametrize("last", [LAST - 2, LAST])
@pytest.mark.parametrize("hold", ["zero", "first"])
def test_every_noise_counts_once(window: int, delay: float, last: int, hold: str) -> None:
    """The predictor's inputs share their noise with the smoothed state that it starts from."""
    config = configure(
        "sensors.imu.rate=10",
        "sensors.imu.sigma=0.5",
        f"sensors.gnss.delay={delay}",
        f"hme.smoother_window={window}",
        f"hme.predictor.hold={hold}",
        tuning="matched",
    )
    known = sensors(config.sensors)
    axis = axis_filter(config.hme1, known)
    chain = resolve("HME1").kernel(Known(known, config), last + 1)
    force = [Measurement(k, FORCE, 0.0, known.force_sigma**2) for k in range(last + 1)]
    fixes = [
        Measurement(k, POSITION, 0.0, known.position_sigma**2)
        for k in range(0, last + 1, known.fix_interval)
    ]
    dense = posterior(axis.model, axis.initial_covariance, np.zeros((last + 1, 1)), force + fixes)
    noises = dense.error.shape[2]
    of_force = noises - len(fixes) - len(force)  # where the noises of the forces stand

    T, steps = known.step, known.delay + window
    A = np.array([[1.0, T, T**2 / 2], [0.0, 1.0, T], [0.0, 0.0, 1.0]])
    held, linear = (
        np.array([[T**2 / 2, T, 0.0]]),
        np.array([[T**2 / 3, T / 2, 0.0], [T**2 / 6, T / 2, 0.0]]),
    )
    columns = held if hold == "zero" else linear  # of the inputs at the beginning, at the end
    start = last - window
    # the last ones: forces that the smoother has not seen
    error = np.zeros((3, noises + steps + 1))
    error[:, :noises] = dense.error[start + 1][[0, 1, 3]]
    walk = known.bias_walk**2 * np.array(
        [
            [T**5 / 20, T**4 / 8, T**3 / 6],
            [T**4 / 8, T**3 / 3, T**2 / 2],
            [T**3 / 6, T**2 / 2, T],
        ]
    )
    gathered = np.zeros((3, 3))
    for i in range(steps):
        error = A @ error
        for j, B in enumerate(columns, start=i):
            seen = start + j <= last
            error[:, of_force + start + j if seen else noises + j] += known.force_sigma * B
        gathered = A @ gathered @ A.T + walk
    expected = error @ error.T + gathered
    np.testing.assert_allclose(chain.covariance[last], expected[:2, :2], rtol=1e-7)
