"""Computes the gains of a Kalman filter with a slow and a fast measurement.

The gains depend only on the model and the tuning, never on data, so all records share them. After a
transient the gains repeat from one slow measurement to the next, a cycle. A gain schedule therefore
stores the transient and one cycle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.errors import InputError
from owtsweep.estimation.discretisation import Discrete

#: Rules for steps without a slow measurement (a position fix); see REPRODUCTION.md, rows "Alg. 6"
#: and "EKF". Equations and sections are those of Ren et al. (2019).
#: proper: the slow rows of H are dropped (Joseph form). mask_columns: K is computed from all rows,
#: then its slow columns are set to zero (text of section 4.3.3), with P = (I - K H) P as printed.
#: mask_rows: K(1:2, :) = 0 as printed in Algorithm 6, and the last fix is held. every_step: the
#: innovation is set to zero, while gain and covariance are computed as if there were a fix at every
#: step (section 5.3's EKF).
RULES = ("proper", "mask_columns", "mask_rows", "every_step")

#: Largest scaled change of the covariance over a cycle that still counts as converged.
TOLERANCE = 1e-13


@dataclass(frozen=True)
class GainSchedule:
    """The filter's gains and covariances: one row per step, until the rows repeat.

    Attributes
    ----------
    K
        Shape (rows, states, 2): gain columns of the slow and of the fast measurement.
    applied
        Shape (rows,): whether the slow measurement corrects the state.
    fresh
        Shape (rows,): whether there is a new slow measurement, and so an innovation. At steps
        without one, the rule `mask_rows` applies the last slow measurement again.
    innovation_variance
        Shape (rows,): variance H P H' + R of the slow measurement's innovation.
    predicted, filtered
        Shape (rows, states, states): covariances P_{k|k-1} and P_{k|k}.
    cycle
        After the last row, the last `cycle` rows repeat for ever.
    """

    K: Array
    applied: NDArray[np.bool_]
    fresh: NDArray[np.bool_]
    innovation_variance: Array
    predicted: Array
    filtered: Array
    cycle: int

    @property
    def rows(self) -> int:
        """The number of stored rows."""
        return len(self.K)

    def row(self, step: NDArray[np.int64] | int) -> NDArray[np.int64]:
        """Return the index of the stored row that serves a step (or each of several steps)."""
        step = np.asarray(step)
        settled = self.rows - self.cycle
        return np.where(step < self.rows, step, settled + (step - settled) % self.cycle)

    def fresh_before(self, step: int) -> int:
        """Count the new slow measurements in the steps 0 to step - 1."""
        stored = self.fresh[:step]
        cycles, rest = divmod(step - len(stored), self.cycle)
        last = self.fresh[self.rows - self.cycle :]
        before, each, begun = (int(np.count_nonzero(f)) for f in (stored, last, last[:rest]))
        return before + cycles * each + begun


def schedule(
    model: Discrete,
    *,
    slow: Array,
    fast: Array,
    slow_variance: float,
    fast_variance: float,
    initial_covariance: Array,
    interval: int,
    steps: int,
    rule: str = "proper",
    start_interval: int | None = None,
    start_steps: int = 0,
) -> GainSchedule:
    """Compute gains by the covariance recursion of Algorithm 6 of Ren et al. (2019).

    The recursion stops when its covariances repeat, or after `steps` steps (rounded up to a whole
    number of intervals). Each step predicts, then corrects with that step's measurements.

    Parameters
    ----------
    slow, fast
        Measurement rows (states,). An all-zero fast row means that the fast signal is an input.
    slow_variance, fast_variance
        Variances of the two measurements.
    initial_covariance
        Covariance (states, states) of the state one step before the first step.
    interval
        Steps between slow measurements, which come at multiples of `interval`.
    steps
        Length of the longest record.
    rule
        One of `RULES`.
    start_interval, start_steps
        During the first `start_steps` steps, slow measurements come every `start_interval` steps;
        None means `interval`.

    Raises
    ------
    InputError
        If the covariance does not stay finite and positive (an unstable rule or tuning).
    """
    from owtsweep.estimation.riccati import GainRows, Pattern, TwoRates, recursion

    n = len(slow)
    rates = TwoRates(model.A, model.Q, slow, fast, slow_variance, fast_variance, RULES.index(rule))
    pattern = Pattern(interval, start_interval or interval, start_steps)
    rows = min(4096, steps)
    gains = GainRows(*(np.empty((0, *shape)) for shape in ((n, 2), (), (n, n), (n, n))))
    filled, quiet, repeats = 0, 0, False
    while not repeats and (filled == 0 or filled < steps):
        rows = min(-(-rows // interval) * interval, -(-steps // interval) * interval)
        gains = GainRows(*(_lengthen(array, rows, filled) for array in gains))
        first = filled
        filled, repeats, quiet = recursion(
            first, rows, quiet, rates, initial_covariance, pattern, TOLERANCE, gains
        )
        _check(gains.Pf, first, filled, rule)
        rows *= 4
    filled = max(-(-filled // interval) * interval, interval)
    step = np.arange(filled)
    fresh = step % np.where(step < start_steps, pattern.start_interval, interval) == 0
    applied = fresh | (rule == "mask_rows")
    K, S, Pm, Pf = (array[:filled] for array in gains)
    return GainSchedule(K, applied, fresh, S, Pm, Pf, interval)


def _lengthen(array: Array, rows: int, filled: int) -> Array:
    """Return an array of `rows` rows that begins with the first `filled` rows of `array`."""
    result = aligned(rows, *array.shape[1:])
    result[:filled] = array[:filled]
    return result


def _check(filtered: Array, first: int, stop: int, rule: str) -> None:
    diagonal = np.diagonal(filtered[first:stop], axis1=1, axis2=2)
    wrong = np.any(~(np.isfinite(diagonal) & (diagonal >= 0.0)), axis=1)
    if np.any(wrong):
        raise InputError(
            f"update_rule: {rule!r} makes the covariance negative or infinite at step "
            f"{first + int(np.argmax(wrong))} with this tuning; use 'proper'"
        )
