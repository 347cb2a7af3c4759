"""An estimate holds quantities of any name and dimension; a hub scheme's looks as it always did."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from owtsweep import Estimate, Innovation

POSITION, VELOCITY, P = np.array([1.0, 2.0]), np.array([3.0, 4.0]), np.eye(4)


@pytest.mark.parametrize(
    "estimate",
    [
        Estimate(POSITION, VELOCITY, P),
        Estimate(position=POSITION, velocity=VELOCITY, covariance=P),
        Estimate(POSITION, velocity=VELOCITY)._replace(covariance=P),
        copy.deepcopy(Estimate(POSITION, VELOCITY, P)),
        pickle.loads(pickle.dumps(Estimate(POSITION, VELOCITY, P))),
    ],
    ids=["positional", "keyword", "replaced", "copied", "pickled"],
)
def test_a_hub_scheme_s_estimate(estimate: Estimate) -> None:
    np.testing.assert_array_equal(estimate.position, POSITION)
    np.testing.assert_array_equal(estimate.velocity, VELOCITY)
    np.testing.assert_array_equal(estimate.covariance, P)
    assert estimate.innovation is None
    assert list(estimate.quantities) == ["position", "velocity"]


def test_other_quantities_have_names_of_their_own() -> None:
    innovation = Innovation(np.zeros(1), np.eye(1))
    estimate = Estimate(angle=np.array([0.1]), strain=np.arange(6.0), innovation=innovation)
    assert list(estimate.quantities) == ["angle", "strain"]
    assert estimate.strain.shape == (6,)
    value, covariance = estimate.innovation or (None, None)
    assert value is innovation.value
    assert covariance is innovation.covariance
    changed = estimate._replace(angle=np.array([0.2]))
    assert changed.angle == 0.2
    assert estimate.angle == 0.1
    assert "angle=array([0.2])" in repr(changed)


def test_a_quantity_that_was_not_given() -> None:
    with pytest.raises(AttributeError, match="the estimate has no position"):
        _ = Estimate(angle=np.zeros(1)).position
    assert not hasattr(Estimate(POSITION, VELOCITY), "angle")
