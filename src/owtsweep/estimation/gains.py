"""Compute the gains of a Kalman filter with a slow and a fast measurement.

The gains depend on the model and on the variances of noise, not on the measured values, so all
records share them. After a transient the gains are periodic: a cycle is the time from one slow
measurement to the next.
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
    """The gains and covariances of a filter with a slow and a fast measurement, a row per step.

    K: gains, shape (rows, states, 2): columns of the slow and of the fast measurement.
    applied: whether a slow measurement corrects the state, new or old, shape (rows,).
    fresh: whether there is a new slow measurement, shape (rows,). At the other steps, the rule
        "mask_rows" applies the last one again.
    innovation_variance: variance H P H' + R of the slow measurement's innovation, shape (rows,).
    predicted, filtered: covariances of the state before and after the measurements of a step, shape
        (rows, states, states).
    cycle: number of rows at the end that repeat for ever, i.e. steps from one slow measurement to
        the next.
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
        return len(self.K)

    def row(self, step: NDArray[np.int64] | int) -> NDArray[np.int64]:
        """Return the index of the row with the gains of a step, or of each of several steps."""
        step = np.asarray(step)
        settled = self.rows - self.cycle
        return np.where(step < self.rows, step, settled + (step - settled) % self.cycle)

    def fresh_before(self, step: int) -> int:
        """Return the number of new slow measurements in the steps 0 to `step` - 1."""
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
    """Compute a filter's gains by the covariance recursion of Algorithm 6 of Ren et al. (2019).

    The recursion stops when the covariances repeat, or after `steps` steps, the length of the
    longest record (rounded up to a multiple of `interval`).

    slow, fast: rows (states,) of the measurement matrix. If `fast` is all zero, the fast signal is
        an input of the model and not a measurement.
    slow_variance, fast_variance: variances of the noise of the two measurements.
    initial_covariance: covariance (states, states) of the state one step before the first step.
    interval: number of steps from one slow measurement to the next; step 0 has one.
    rule: how a step without a slow measurement is treated, one of `RULES`.
    start_interval, start_steps: in the first `start_steps` steps, slow measurements come every
        `start_interval` steps (None: every `interval`).
    Raises InputError if a variance of a state becomes negative or not finite, because the rule or
    the noise variances make the recursion unstable.
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
