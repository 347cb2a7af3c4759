"""What the check of schemes takes for equal measurements."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from owtsweep.studies.base.schemes import identify


@dataclass
class Measured:
    names: np.ndarray
    force: np.ndarray


def test_measurements_may_hold_texts_and_gaps():
    one = Measured(np.array(["x", "y"]), np.array([1.0, np.nan]))
    other = deepcopy(one)
    assert identify(one) == identify(other)
    other.names[0] = "z"
    assert identify(one) != identify(other)
    other = deepcopy(one)
    other.force[0] = 2.0
    assert identify(one) != identify(other)
