"""Which arrival state and which covariance each window of HME2 is given."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure

from owtsweep.estimation.mhe import window_maps
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.horizon import horizon, transition_over
from owtsweep.studies.hub.sensors import sensors

pytestmark = pytest.mark.usefixtures("kernels")

LENGTH, M = 4, 10


def test_the_arrival_is_the_filter_of_one_window_ago() -> None:
    config = configure("hme.mhe.arrival=mkf", tuning="matched")
    known = sensors(config.sensors)
    chain = resolve("HME2").kernel(Known(known, config), 600)
    mhe = horizon(config.hme.mhe, known)
    assert (mhe.length, known.fix_interval, mhe.first) == (LENGTH, M, 0)
    for fix in (0, 2, 3):  # the window fills: full information with the initial covariance
        prior = np.diag([1.0, 1.0, 0.01])
        expected = next(window_maps(mhe.weights, fix, [prior]))
        found = chain.mhe.maps[fix, :, : expected.shape[1]]
        np.testing.assert_allclose(found, expected, rtol=1e-12)
    for fix in (4, 7, 30):
        P = chain.gains.filtered[(fix - LENGTH) * M][np.ix_([0, 1, 3], [0, 1, 3])]
        expected = next(window_maps(mhe.weights, LENGTH, [P], use_first_fix=False))
        np.testing.assert_allclose(chain.mhe.maps[fix], expected, rtol=1e-12)
        assert np.all(expected[:, 0] == 0.0)  # the oldest fix is already in the filter's state


def test_without_arrival_fixes_pass_until_three_are_there() -> None:
    config = configure("hme.mhe.arrival=none", tuning="matched")
    known = sensors(config.sensors)
    chain = resolve("HME2").kernel(Known(known, config), 600)
    assert chain.mhe.first == 2
    fresh = np.flatnonzero(chain.gains.fresh[: 2 * M + 5])
    assert fresh.tolist() == [0, M, 2 * M, 2 * M + 2, 2 * M + 4]  # T_g first, then T_m


def test_links_are_those_of_one_fix_interval() -> None:
    config = configure("hme.mhe.weights=full", tuning="matched")
    known = sensors(config.sensors)
    weights = horizon(config.hme.mhe, known).weights
    T, q = known.fix_step, known.force_sigma**2 * known.step
    np.testing.assert_allclose(weights.transition, transition_over(T), rtol=1e-12)
    Q = weights.link_covariance
    b = known.bias_walk**2
    assert Q[0, 0] == pytest.approx(q * T**3 / 3 + b * T**5 / 20)
    assert Q[0, 1] == pytest.approx(q * T**2 / 2 + b * T**4 / 8)
    assert Q[2, 2] == pytest.approx(b * T)
    diagonal = horizon(configure("hme.mhe.weights=diagonal", tuning="matched").hme.mhe, known)
    np.testing.assert_array_equal(diagonal.weights.link_covariance, np.diag(np.diagonal(Q)))
