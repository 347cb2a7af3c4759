"""Corrects the tests of many hypotheses for their number, by Holm's method."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from owtsweep.statistics.student import CONFIDENCE


def holm(p_values: ArrayLike) -> NDArray[np.bool_]:
    """Return a mask of the hypotheses that Holm's test rejects at a family-wise error of 5 %.

    `p_values` holds one p-value per hypothesis, shape (n,). Source: Holm (1979), A simple
    sequentially rejective multiple test procedure.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    passed = p[order] <= (1.0 - CONFIDENCE) / (p.size - np.arange(p.size))
    rejected = np.zeros(p.size, dtype=bool)
    rejected[order] = np.logical_and.accumulate(passed)
    return rejected
