"""The hub's compiled kernels are a fast path: they equal the general Kalman filter."""

from __future__ import annotations

import numpy as np
import pytest
from tools import assert_same, configure, measured, ned, run_batch

from owtsweep.estimation.kalman import apply_gains, run_filter, schedule_gains
from owtsweep.estimation.kalman_step import predict_covariance
from owtsweep.estimation.linear import LinearModel
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.models import POSITION, AxisFilter, axis_filter
from owtsweep.studies.hub.resolving import resolve


def linear_model(axis: AxisFilter) -> LinearModel:
    """One axis of the hub's filter; the specific force is a measurement or an input."""
    A, B, Q = axis.model.A, axis.model.B, axis.model.Q
    if not np.any(axis.force_row):
        return LinearModel(A, Q, POSITION[None], np.diag([axis.position_variance]), B)
    rows = np.stack([POSITION, axis.force_row])
    return LinearModel(A, Q, rows, np.diag([axis.position_variance, axis.force_variance]))


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("model", ["sigma1", "sigma2"])
def test_the_mkf_is_the_general_filter(model: str) -> None:
    config = configure(f"mkf.model={model}", "mkf.update_rule=proper", tuning="matched")
    data, sensors = measured(config)
    run = run_batch(resolve("MKF"), config, data, sensors)
    axis = axis_filter(config.mkf, sensors)
    general = linear_model(axis)
    prior = predict_covariance(axis.initial_covariance, general.F, general.Q)
    force, positions = (values.T[:, :, None] for values in ned(data, sensors))
    fixes = np.full_like(force, np.nan)
    fixes[:, :: sensors.fix_interval] = positions
    if general.B is None:
        z, inputs = np.concatenate([fixes, force], axis=2), None
    else:  # the input of a step is the force at its beginning
        z, inputs = fixes, force
    filtered = run_filter(general, z, state=np.zeros(4), covariance=prior, inputs=inputs)
    states = filtered.filtered.transpose(1, 2, 0).reshape(len(run.filtered), 8)
    assert_same(states, run.filtered, "states")
    both = np.kron(filtered.covariance[0], np.eye(2))
    assert_same(both, run.covariance, "covariances")
    assert_same(filtered.innovation[:, :: sensors.fix_interval, 0].T,
                run.innovation[:: sensors.fix_interval], "innovations")  # fmt: skip

    cycle = np.isfinite(z[0, : sensors.fix_interval])
    gains = schedule_gains(general, prior, cycle, len(force[0]))
    scheduled = apply_gains(general, gains, z, state=np.zeros(4), inputs=inputs)
    assert_same(scheduled.filtered[0], filtered.filtered[0], "scheduled states", 1e-12)
    chain: Chain = resolve("MKF").kernel(sensors, config, len(force[0]))  # type: ignore
    step = np.arange(len(force[0]))
    columns = general.measurements
    compiled = chain.gains.K[chain.gains.row(step)][:, :, :columns]
    general_K = filtered.gains.K[0]
    assert_same(general_K, compiled, "gains")
