"""Holm's correction against its definition."""

from __future__ import annotations

import numpy as np
from naive_holm import naive_holm

from owtsweep.statistics.inference import holm


def test_holm_is_the_step_down_procedure():
    random = np.random.default_rng(3)
    for size in (1, 2, 7, 60):
        for spread in (1.0, 3.0, 6.0):
            p_values = list(random.uniform(size=size) ** spread)
            assert holm(p_values).tolist() == naive_holm(p_values, 0.05)
    # the third would fall at its own level of 5 %, but the second stops the descent
    assert holm([0.001, 0.03, 0.04]).tolist() == [True, False, False]
