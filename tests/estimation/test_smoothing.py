"""Smoothers against brute force, over the whole record and with a lag."""

from __future__ import annotations

import numpy as np
import pytest
from joint import Joint, draw_case

from owtsweep.errors import InputError
from owtsweep.estimation.kalman import run_filter
from owtsweep.estimation.smoothing import smooth, smooth_fixed_lag

CASES = [
    {"seed": 1, "n": 1, "m": 1},
    {"seed": 2, "n": 3, "m": 2, "lost": 0.5},
    {"seed": 3, "n": 6, "m": 4, "lost": 0.3, "changing": True},
    {"seed": 4, "n": 4, "m": 1, "inputs": 2, "lost": 0.3},
    {"seed": 5, "n": 4, "m": 2, "lost": 0.2, "rank": 2},  # two directions are known exactly
    {"seed": 6, "n": 3, "m": 1, "rank": 1, "changing": True},
]


@pytest.mark.parametrize("settings", CASES, ids=str)
@pytest.mark.parametrize("lag", [None, 0, 1, 4, 50])
def test_smoother_is_dense_conditioning(settings: dict, lag: int | None) -> None:
    case = draw_case(**settings)
    run = run_filter(
        case.model, case.z, state=case.mean, covariance=case.covariance, inputs=case.inputs
    )
    result = smooth(run) if lag is None else smooth_fixed_lag(run, lag)
    joint = Joint(case)
    for s, z in enumerate(case.z):
        for k in range(len(z)):
            used = np.isfinite(z)
            if lag is not None:
                used[k + lag + 1 :] = False
            mean, covariance = joint.condition(z, used, k)
            np.testing.assert_allclose(result.state[s, k], mean, rtol=1e-7, atol=1e-7)
            np.testing.assert_allclose(result.covariance[s, k], covariance, rtol=1e-7, atol=1e-7)


def test_units_do_not_matter() -> None:
    """The same model in millimetres and kilometres: P spans 24 decades."""
    case = draw_case(7, 4, 2)
    scale = np.array([1e-6, 1.0, 1e3, 1e6])
    other = type(case.model)(
        scale[:, None] * case.model.F / scale,
        scale[:, None] * case.model.Q * scale,
        case.model.H / scale,
        case.model.R,
    )
    here = smooth(run_filter(case.model, case.z, state=case.mean, covariance=case.covariance))
    there = smooth(
        run_filter(
            other, case.z, state=scale * case.mean,
            covariance=scale[:, None] * case.covariance * scale,
        )
    )  # fmt: skip
    np.testing.assert_allclose(there.state / scale, here.state, rtol=1e-7, atol=1e-8)


def test_a_negative_lag_is_refused() -> None:
    case = draw_case(8, 1, 1)
    run = run_filter(case.model, case.z, state=case.mean, covariance=case.covariance)
    with pytest.raises(InputError, match="lag: -1 steps; give 0 or more"):
        smooth_fixed_lag(run, -1)
