"""Gains of a filter whose slow measurement reports a past output, for all steps of a record.

The gains depend on the model and on the variances of noise, not on measured values. After a
transient they are periodic: the period, a cycle, is the time from one slow measurement to the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.late_model import LateModel

#: Largest scaled change of the covariance over a cycle that still counts as converged.
TOLERANCE = 1e-12
#: Number of steps of the first attempt to reach the cycle; each further attempt has twice as many.
FIRST_STEPS = 8192


class LateRows(NamedTuple):
    """The arrays that the covariance recursion fills.

    Attributes
    ----------
    fast
        Gains of the fast measurement, shape (rows, N), one row per step.
    slow
        Gains of the slow measurement, shape (rows / interval, N), one row per slow measurement.
    S
        Variance of the slow measurement's innovation, shape (rows / interval,).
    outputs
        Covariance (c, c) of c outputs of the state after the measurements of a step, shape
        (rows, c, c).
    """

    fast: Array
    slow: Array
    S: Array
    outputs: Array


@dataclass(frozen=True, eq=False)
class LateGains:
    """The gains and covariances of a filter, for steps 0, 1, ... of every record.

    The state has N numbers: the n states of the shaping filter, the bias, and the copies (see
    `estimation.late_model`). After the last row, the last `cycle` rows repeat for ever.

    Attributes
    ----------
    fast
        Gains of the fast measurement, shape (rows, N), one row per step.
    slow
        Gains of the slow measurement, shape (rows / cycle, N), one row per slow measurement.
    innovation_variance
        Variance of the slow measurement's innovation, shape (rows / cycle,).
    covariance
        Covariance of the c chosen outputs after the measurements of a step, shape (rows, c, c).
    cycle
        Number of rows that repeat: steps from one slow measurement to the next.
    repeats
        Whether the covariances have settled; otherwise they still moved at the last row.
    """

    fast: Array
    slow: Array
    innovation_variance: Array
    covariance: Array
    cycle: int
    repeats: bool

    @property
    def rows(self) -> int:
        """The number of stored rows."""
        return len(self.fast)


def schedule_late(model: LateModel, first: Array, outputs: Array, steps: int) -> LateGains:
    """Compute the gains of a filter until they repeat.

    Parameters
    ----------
    model
        The model, with a state of N numbers, n of them states of the shaping filter.
    first
        Covariance (N, N) of the state one step before step 0.
    outputs
        Rows (c, n) of the outputs whose covariances are wanted.
    steps
        Number of steps of the longest record: gains are computed for at most so many steps, rounded
        up to a whole number of cycles.

    Raises
    ------
    InputError
        If a variance of an output becomes negative or not finite, because the numbers of the model
        differ too much in magnitude.
    """
    from owtsweep.estimation.late import late_recursion

    N, M, c = len(first), model.interval, len(outputs)
    last = -(-steps // M) * M
    rows = LateRows(*(np.empty((0, *shape)) for shape in ((N,), (N,), (), (c, c))))
    P, before = first.copy(), np.full((N, N), np.nan)
    filled, repeats, size = 0, False, FIRST_STEPS
    while not repeats and filled < last:
        size = min(-(-size // M) * M, last)
        rows = LateRows(
            _lengthen(rows.fast, size),
            _lengthen(rows.slow, size // M),
            _lengthen(rows.S, size // M),
            _lengthen(rows.outputs, size),
        )
        filled, repeats = late_recursion(
            filled, size, model, P, np.ascontiguousarray(outputs), TOLERANCE, before, rows
        )
        size *= 2
    covariance = rows.outputs[:filled]
    variances = np.diagonal(covariance, axis1=1, axis2=2)
    if not np.all(np.isfinite(variances) & (variances > 0.0)):
        raise InputError(
            "skf: the filter's covariance is negative or infinite, because the variances of "
            "motion, sensors and bias differ too much in magnitude; use less extreme values"
        )
    return LateGains(
        fast=rows.fast[:filled].copy(),
        slow=rows.slow[: filled // M].copy(),
        innovation_variance=rows.S[: filled // M].copy(),
        covariance=covariance.copy(),
        cycle=M,
        repeats=repeats,
    )


def _lengthen(array: Array, rows: int) -> Array:
    """Return an array of `rows` rows that begins with the rows of `array`."""
    result = np.empty((rows, *array.shape[1:]))
    result[: len(array)] = array
    return result
