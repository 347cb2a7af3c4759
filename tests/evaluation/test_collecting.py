"""Estimates become one trajectory; what does not fit is named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from owtsweep import Estimate, Innovation
from owtsweep.evaluation.loop import collect


def test_position_and_velocity_stand_in_this_order() -> None:
    innovation = Innovation(np.array([0.5]), np.array([[2.0]]))
    estimates = [
        Estimate(velocity=np.array([1.0, 2.0]), position=np.array([3.0, 4.0]), heat=np.zeros(9)),
        Estimate([5.0, 6.0], [7.0, 8.0], covariance=np.eye(4), innovation=innovation),
    ]
    trajectory = collect(estimates, 2)
    assert trajectory.state.tolist() == [[3.0, 4.0, 1.0, 2.0], [5.0, 6.0, 7.0, 8.0]]
    assert trajectory.covariance is not None
    assert np.isnan(trajectory.covariance[0]).all()
    np.testing.assert_array_equal(trajectory.covariance[1], np.eye(4))
    np.testing.assert_array_equal(trajectory.innovation, [[np.nan], [0.5]])
    np.testing.assert_array_equal(trajectory.innovation_covariance, [[[np.nan]], [[2.0]]])


def test_what_nobody_gave_is_not_there() -> None:
    trajectory = collect([Estimate([0.0, 0.0], [0.0, 0.0])], 1)
    assert trajectory[1:] == (None, None, None)


@pytest.mark.parametrize(
    ("estimate", "error", "message"),
    [
        (Estimate([0.0, 0.0]), ValueError, "the estimate of step 7 has no velocity"),
        (
            Estimate([0.0, 0.0], np.zeros(3)),
            ValueError,
            r"the velocity of step 7 has the shape \(3,\), not \(2,\)",
        ),
        ((0.0, 0.0), TypeError, "update gave a tuple, not an owtsweep.Estimate"),
    ],
)
def test_what_does_not_fit(estimate: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        collect([estimate], 1, first=7)
