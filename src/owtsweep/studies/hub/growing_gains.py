"""Gains of one axis of SKF, computed only for as many steps as were asked for so far.

SKFA uses a model for a few minutes or for hours, and nobody knows beforehand which it will be.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.estimation.late_gains import TOLERANCE, LateRows
from owtsweep.studies.hub.spectral_axis import LONGEST_TRANSIENT, SpectralAxis

#: Least number of steps that are computed at a time: long enough for the minute that a new model
#: filters again, and short enough (3 ms) for an estimator on board.
CHUNK = 8192


class GrowingGains:
    """The gains of a model, which grow until they repeat.

    Parameters
    ----------
    axis
        The model, with a state of N numbers.
    """

    def __init__(self, axis: SpectralAxis) -> None:
        N = len(axis.first)
        self._axis, self._filled, self._repeats = axis, 0, False
        self._covariance, self._before = axis.first.copy(), np.full((N, N), np.nan)
        self._rows = LateRows(np.empty((0, N)), np.empty((0, N)), np.empty(0), np.empty((0, 2, 2)))

    def find(self, steps: int) -> LateRows:
        """Return the gains of at least the first `steps` steps, or of fewer if they repeat.

        After the last row, at the latest after `LONGEST_TRANSIENT` steps, the
        rows of the last fix interval repeat for ever.

        Raises
        ------
        InputError
            If a variance becomes negative or not finite, because the numbers of the model differ
            too much in magnitude.
        """
        while self._filled < min(steps, LONGEST_TRANSIENT) and not self._repeats:
            self._grow()
        return self._rows

    def _grow(self) -> None:
        from owtsweep.estimation.late import late_recursion

        axis, interval = self._axis, self._axis.model.interval
        fixes = -(-min(CHUNK, LONGEST_TRANSIENT - self._filled) // interval)
        more = fixes * interval, fixes, fixes, fixes * interval
        rows = LateRows(
            *(_lengthen(array, count) for array, count in zip(self._rows, more, strict=True))
        )
        first, stop = self._filled, len(rows.fast)
        filled, self._repeats = late_recursion(
            first, stop, axis.model, self._covariance, axis.outputs, TOLERANCE, self._before, rows
        )
        variances = np.diagonal(rows.outputs[first:filled], axis1=1, axis2=2)
        require(
            bool(np.all(np.isfinite(variances) & (variances > 0.0))),
            "skf: the filter's covariance is negative or infinite, because the variances of "
            "motion, sensors and bias differ too much in magnitude; use less extreme values",
        )
        if self._repeats:
            kept = filled, filled // interval, filled // interval, filled
            rows = LateRows(*(array[:n].copy() for array, n in zip(rows, kept, strict=True)))
        self._rows, self._filled = rows, filled


def _lengthen(array: Array, count: int) -> Array:
    """Return a copy of an array with `count` rows more, to be filled."""
    return np.concatenate([array, np.empty((count, *array.shape[1:]))])
