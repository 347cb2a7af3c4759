"""Trajectories: what an estimator does not state is NaN, and covariances of one axis."""

from __future__ import annotations

import numpy as np

from owtsweep.evaluation.trajectory import Trajectory, spread_to_both_axes


def make_trajectory(steps=9) -> Trajectory:
    draw = np.random.default_rng(2)
    return Trajectory(
        draw.normal(size=(steps, 4)), draw.normal(size=(steps, 4, 4)) ** 2,
        draw.normal(size=(steps, 2)), draw.normal(size=(steps, 2, 2)) ** 2,
    )  # fmt: skip


def test_without_a_covariance_all_is_nan():
    bare = Trajectory(np.zeros((3, 4)))
    assert bare.deviation.shape == (3, 4)
    assert bare.axis_covariance(1).shape == (3, 2, 2)
    assert np.isnan(bare.deviation).all()


def test_an_axis_covariance_is_that_of_its_position_and_velocity():
    one = np.array([[[4.0, 1.0], [1.0, 9.0]]])
    both = Trajectory(np.zeros((1, 4)), spread_to_both_axes(one))
    assert np.array_equal(both.axis_covariance(0), one)
    assert np.array_equal(both.axis_covariance(1), one)
    assert np.array_equal(both.deviation, [[2.0, 2.0, 3.0, 3.0]])
    assert both.covariance[0, 0, 3] == 0.0
    whole = make_trajectory()
    assert whole.axis_covariance(1)[5, 0, 1] == whole.covariance[5, 1, 3]
