"""What the ordinates of a periodogram say of many densities at once, for `candidates`."""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit

#: Number of densities whose product is formed before its logarithm is taken.
TOGETHER = 8


@njit
def add_up(shapes, sizes, beside, periodogram, sums):
    """Add up log density and periodogram / density over the ordinates, for all shapes and sizes.

    shapes: densities of a size of 1, (shapes, ordinates).
    beside, periodogram: density of all else, and what was measured, (ordinates,).
    sums: zeros, (shapes, sizes), to which the sums are added.
    """
    product = np.ones(len(sizes))
    for i in range(len(shapes)):
        for k in range(len(beside)):
            for v in range(len(sizes)):
                density = shapes[i, k] * sizes[v] + beside[k]
                product[v] *= density
                sums[i, v] += periodogram[k] / density
            if k % TOGETHER == 0 or k == len(beside) - 1:
                for v in range(len(sizes)):
                    sums[i, v] += np.log(product[v])
                    product[v] = 1.0
