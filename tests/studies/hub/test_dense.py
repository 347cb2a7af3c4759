"""The batch engine's filter against least squares over the whole record, at a yaw."""

from __future__ import annotations

import numpy as np
import pytest
from dense import Measurement, posterior
from tools import configure, filtered_states, measured, ned

from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.models import FORCE, POSITION, axis_filter

pytestmark = pytest.mark.usefixtures("kernels")


@pytest.mark.parametrize("model", ["sigma1", "sigma2"])
def test_mkf_is_the_least_squares_solution(model: str) -> None:
    config = configure(
        "record.duration=3",
        "hme.mhe.smoother_window=null",
        "measures.settling_time=1",
        f"mkf.model={model}",
        "sensors.imu.rate=10",
        tuning="matched",
    )
    data, sensors = measured(config)
    force, fixes = ned(data, sensors)
    axis = axis_filter(config.mkf, sensors)
    chain = resolve("MKF").kernel(Known(sensors, config), len(force))
    states = filtered_states(chain, force, fixes).reshape(len(force), 4, 2)
    known = np.array([0, 1, 3] if model == "sigma2" else [0, 1, 2, 3])  # what the data determine
    for last in (3, 5, len(force) - 1):  # between fixes, at one, and later
        for lane in range(2):
            M = sensors.fix_interval
            found = [
                Measurement(k, POSITION, fixes[k // M, lane], sensors.position_sigma**2)
                for k in range(0, last + 1, M)
            ]
            inputs = np.zeros((last + 1, 1))
            if model == "sigma1":
                found += [
                    Measurement(k, FORCE, force[k, lane], sensors.force_sigma**2)
                    for k in range(last + 1)
                ]
            else:
                inputs[1:, 0] = force[:last, lane]
            dense = posterior(axis.model, axis.initial_covariance, inputs, found)
            expected = dense.mean[-1][known]
            assert np.max(np.abs(states[last, known, lane] - expected)) <= 1e-8 * np.max(
                np.abs(dense.mean)
            )
            P = chain.gains.filtered[chain.gains.row(last)]
            np.testing.assert_allclose(
                P[np.ix_(known, known)],
                dense.covariance[-1, :, -1][np.ix_(known, known)],
                rtol=1e-7,
                atol=1e-11,
            )
