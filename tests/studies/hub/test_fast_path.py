"""The hub's compiled kernels are a fast path: they equal a Kalman filter written out."""

from __future__ import annotations

import numpy as np
import pytest
from tools import assert_same, configure, measured, ned, run_batch

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.models import POSITION, AxisFilter, axis_filter


def run_filter(axis: AxisFilter, fixes: Array, force: Array) -> tuple[Array, ...]:
    """Run the filter of one axis over a record (Anderson and Moore 1979, section 3.1).

    `fixes` is NaN where there is none. The specific force is a measurement if the filter has a row
    for it, else an input, which acts from its step on. Returned are states, covariances, gains and
    innovations of the fixes after each step's measurements.
    """
    A, B, Q = axis.model.A, axis.model.B.ravel(), axis.model.Q
    is_measured = bool(np.any(axis.force_row))
    rows = np.stack([POSITION, axis.force_row]) if is_measured else POSITION[None]
    noise = np.diag([axis.position_variance, axis.force_variance][: len(rows)])
    x, P = np.zeros(4), A @ axis.initial_covariance @ A.T + Q
    found = []
    for fix, sample in zip(fixes, force, strict=True):
        z = np.array([fix, sample][: len(rows)])
        e = z - rows @ x
        there = np.isfinite(z)
        H = rows[there]
        K = np.zeros((4, len(rows)))
        K[:, there] = P @ H.T @ np.linalg.inv(H @ P @ H.T + noise[np.ix_(there, there)])
        rest = np.eye(4) - K[:, there] @ H
        x, P = x + K[:, there] @ e[there], rest @ P @ rest.T + K @ noise @ K.T
        found.append((x, P, K, e[0]))
        x, P = A @ x + (0.0 if is_measured else B * sample), A @ P @ A.T + Q
    return tuple(map(np.array, zip(*found, strict=True)))


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("model", ["sigma1", "sigma2"])
def test_the_mkf_is_the_kalman_filter(model: str) -> None:
    config = configure(f"mkf.model={model}", "mkf.update_rule=proper", tuning="matched")
    data, sensors = measured(config)
    run = run_batch(resolve("MKF"), config, data, sensors)
    axis = axis_filter(config.mkf, sensors)
    force, positions = ned(data, sensors)
    fixes = np.full_like(force, np.nan)
    fixes[:: sensors.fix_interval] = positions
    of_axes = [run_filter(axis, *series) for series in zip(fixes.T, force.T, strict=True)]
    (_, P, K, _), _ = of_axes
    states, innovations = (np.stack([of[i] for of in of_axes], axis=-1) for i in (0, 3))
    assert_same(states.reshape(run.filtered.shape), run.filtered, "states")
    assert_same(np.kron(P, np.eye(2)), run.covariance, "covariances")
    at_fixes = slice(None, None, sensors.fix_interval)
    assert_same(innovations[at_fixes], run.innovation[at_fixes], "innovations")
    chain: Chain = resolve("MKF").kernel(Known(sensors, config), len(force))
    compiled = chain.gains.K[chain.gains.row(np.arange(len(force)))]
    assert_same(K, compiled[:, :, : K.shape[2]], "gains")
