"""A motion with a known spectrum, seen by a fast sensor and by a slow one that reports the past.

The model is one axis of a motion that a shaping filter makes of white noise. A fast sensor with a
bias measures it at every step, a slow sensor every `interval` steps. The slow measurement reports
the output of `delay` steps before its arrival. So the state keeps a copy of each output whose
report is still to come. A copy is correlated with the state as the output itself was, and the late
measurement is applied to the copy exactly: stochastic cloning (Roumeliotis and Burdick 2002).

The noise of the slow measurement may have a red part besides the white one, a first-order
Gauss-Markov process, which is a state too.

The state has N numbers: the n states of the shaping filter, the bias of the fast sensor, the red
noise (none or one), and the copies, the newest first. In each step the state is predicted, the fast
measurement is applied, then the slow one if there is one, and then the output is copied if it will
be reported.

If all slow measurements arrive and count alike, the gains depend on the model and on the variances
of noise, not on measured values. So they are computed first (`LateGains`), and one kernel,
`follow`, runs the filter on them: on one series, or on several side by side. The gains are periodic
after a transient: the period is the time from one slow measurement to the next. For measurements
that are missing or doubtful see `weighing`.
"""

from __future__ import annotations

from threading import Lock
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, Rows, make_rows
from owtsweep.compiled import njit, part
from owtsweep.errors import require
from owtsweep.estimation.windowing import schedule_row

#: Largest scaled change of the covariance over an interval that still counts as settled.
TOLERANCE = 1e-12
#: Number of steps whose gains are computed at a time: few enough (1 ms) for an estimator on board.
#: Always as many, so that it does not matter how a record is cut.
CHUNK = 1024
#: Held while gains are computed, which filters in several threads may share.
_COMPUTING = Lock()


class LateModel(NamedTuple):
    """A model in discrete time with a fast measurement and a slow measurement that comes late.

    A: transition matrix of the shaping filter as blocks along its diagonal, shape (n / 2, 2, 2).
    Q: covariance of the shaping filter's process noise, shape (n, n).
    walk: variance that the bias of the fast sensor gains in a step.
    fast, slow: rows (n,): the fast measurement without bias and noise, and the output that the slow
        measurement reports.
    r_fast, r_slow: variances of the noise of the two measurements.
    interval, delay: steps from one slow measurement to the next, the first at step 0, and age of
        the output that it reports, in steps.
    copies: number of copies in the state: delay / interval, rounded up.
    reds, fade, red: number of states of red noise, 0 or 1; the factor by which it fades in a step,
        and the variance that it gains in a step.
    """

    A: Array
    Q: Array
    walk: float
    fast: Array
    slow: Array
    r_fast: float
    r_slow: float
    interval: int
    delay: int
    copies: int
    reds: int = 0
    fade: float = 1.0
    red: float = 0.0


class LateRows(NamedTuple):
    """The gains and covariances of successive steps.

    fast: gains of the fast measurement, shape (rows, N), one row per step.
    slow: gains of the slow measurement, shape (fixes, N), one row per step at which one is due.
    variance: variance of the slow measurement's innovation, shape (fixes,).
    outputs: covariance of the c chosen outputs after the measurements of a step, shape
        (rows, c, c).
    """

    fast: Array
    slow: Array
    variance: Array
    outputs: Array


def transition(model: LateModel) -> Array:
    """Return the transition matrix (N, N) of a state over a step, without a new copy."""
    n = len(model.Q)
    F = np.eye(n + 1 + model.reds + model.copies)
    for i, block in enumerate(model.A):
        F[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
    if model.reds:
        F[n + 1, n + 1] = model.fade
    return F


def process_noise(model: LateModel) -> Array:
    """Return the covariance (N, N) that a state gains in a step."""
    n = len(model.Q)
    N = n + 1 + model.reds + model.copies
    Q = np.zeros((N, N))
    Q[:n, :n] = model.Q
    Q[n, n] = model.walk
    if model.reds:
        Q[n + 1, n + 1] = model.red
    return Q


def copying(model: LateModel) -> Array:
    """Return the matrix (N, N) that makes the present output the newest copy of a state.

    It moves the other copies on by one place and drops the oldest.
    """
    n = len(model.Q)
    new = n + 1 + model.reds
    N = new + model.copies
    C = np.eye(N)
    if model.copies:
        C[new:] = 0.0
        C[new, :n] = model.slow
        C[range(new + 1, N), range(new, N - 1)] = 1.0
    return C


def measurement_rows(model: LateModel) -> tuple[Array, Array]:
    """Return what the fast and the slow measurement see of a state, shape (N,) each."""
    n = len(model.Q)
    fast, slow = np.zeros((2, n + 1 + model.reds + model.copies))
    fast[:n], fast[n] = model.fast, 1.0
    if model.copies:
        slow[-1] = 1.0
    else:
        slow[:n] = model.slow
    slow[n + 1 : n + 1 + model.reds] = 1.0
    return fast, slow


def find_first_covariance(model: LateModel, stationary: Array, bias_variance: float) -> Array:
    """Compute the covariance (N, N) of the state one step before step 0.

    The first slow measurements report outputs of before step 0, so the state already has their
    copies. `stationary` (n, n) is the covariance of the shaping filter's states.
    """
    n = len(model.Q)
    predict, copy, Q = transition(model), copying(model), process_noise(model)
    Q[n, n] = 0.0  # the variance of the bias is that of the start
    P = np.zeros_like(Q)
    P[:n, :n] = stationary
    P[n, n] = bias_variance
    if model.reds:
        P[n + 1, n + 1] = model.red / (1.0 - model.fade**2)
    for step in range(-model.delay, 0):
        if step > -model.delay:
            P = predict @ P @ predict.T + Q
        if (step + model.delay) % model.interval == 0:
            P = copy @ P @ copy.T
    return 0.5 * (P + P.T)


class LateGains:
    """The gains for steps 0, 1, ... if every slow measurement arrives; computed at first use.

    first: covariance (N, N) of the state one step before step 0.
    outputs: rows (c, n) of the outputs whose covariances are wanted.
    """

    def __init__(self, model: LateModel, first: Array, outputs: Array) -> None:
        self.model, self.first = model, first
        self._outputs = np.ascontiguousarray(outputs)
        # longer than what is filled, so that it seldom grows
        self._rows, self._filled = self._make_rows(0), 0
        # covariances before some steps, of which the last is that after the last row
        self._passed, self._before = {0: first}, np.full_like(first, np.nan)
        #: Number of steps whose gains are computed at a time, a multiple of the interval.
        self.span = -(-CHUNK // model.interval) * model.interval
        #: Whether the last interval's rows repeat for ever; otherwise the covariance still moves.
        self.repeats = False

    def find(self, steps: int) -> LateRows:
        """Return the gains of at least the first `steps` steps, or of fewer if they repeat.

        The number of rows is a multiple of the interval between slow measurements.

        Raises InputError if a variance of an output becomes negative or not finite, because the
        numbers of the model differ too much in magnitude.
        """
        with _COMPUTING:
            while self._filled < steps and not self.repeats:
                first, P = self._filled, self._passed[self._filled].copy()
                if first + self.span > len(self._rows.fast):
                    longer = self._make_rows(max(2 * first, self.span))
                    for new, old in zip(longer, self._rows, strict=True):
                        new[: len(old)] = old  # the rest takes no memory yet
                    self._rows = longer
                rows = self._cut(first, first + self.span)
                filled, self.repeats = self._fill(first, P, self._before, TOLERANCE, rows)
                self._filled += filled
                self._passed[self._filled] = P
            return self._cut(0, self._filled)

    def find_covariance(self, step: int) -> Array:
        """Compute the covariance (N, N) of the state before a step, a multiple of the interval."""
        with _COMPUTING:
            if self.repeats:
                step = min(step, self._filled)
            passed = max(one for one in self._passed if one <= step)
            P = self._passed[passed].copy()
            if passed < step:
                rows = self._make_rows(step - passed)
                self._fill(passed, P, np.full_like(P, np.nan), 0.0, rows)
            return P

    def _fill(
        self, first: int, P: Array, before: Array, tolerance: float, rows: LateRows
    ) -> tuple[int, bool]:
        """Fill the rows of some intervals as `fill_rows`; P and `before` are overwritten."""
        filled, repeats = fill_rows(first, self.model, P, self._outputs, tolerance, before, rows)
        variances = np.diagonal(rows.outputs[:filled], axis1=1, axis2=2)
        require(
            bool(np.all(np.isfinite(variances) & (variances > 0.0))),
            "skf: the filter's covariance is negative or infinite, because the variances of "
            "motion, sensors and bias differ too much in magnitude; use less extreme values",
        )
        return filled, repeats

    def _cut(self, first: int, stop: int) -> LateRows:
        """Return the rows of some steps, whole intervals."""
        rows, interval = self._rows, self.model.interval
        fast, outputs = rows.fast[first:stop], rows.outputs[first:stop]
        fixes = slice(first // interval, stop // interval)
        return LateRows(fast, rows.slow[fixes], rows.variance[fixes], outputs)

    def _make_rows(self, steps: int) -> LateRows:
        """Make rows for some steps, whole intervals."""
        N, c, fixes = len(self.first), len(self._outputs), steps // self.model.interval
        shapes = (steps, N), (fixes, N), (fixes,), (steps, c, c)
        return LateRows(*(np.empty(shape) for shape in shapes))


@njit
def fill_rows(first, model, P, outputs, tolerance, before, filled):
    """Compute gains and covariances step by step, until they repeat.

    They repeat if no element of the covariance differs from the one `interval` steps earlier by
    more than `tolerance`. Elements (i, j) are divided by the root of the product of the diagonal
    elements i and j.

    first: the step of the first row.
    P: covariance of the state one step before `first`, shape (N, N); overwritten.
    outputs: rows (c, n) of the outputs whose covariances are wanted.
    before: covariance one interval before P, shape (N, N), of which only elements (i, j) with
        j <= i count; NaN if there is none; overwritten.
    filled: the `LateRows` to fill.
    Returns: the number of filled rows, and whether the last `interval` rows repeat.
    """
    interval, steps = model.interval, len(filled.fast)
    work, q = np.empty(len(model.Q)), 0
    for i in range(steps):
        k = first + i
        predict_covariance(model, P)
        apply_fast(model, P, filled.fast[i])
        if k % interval == 0:
            filled.variance[q] = apply_slow(model, P, filled.slow[q])
            q += 1
        write_outputs(P, outputs, work, filled.outputs[i])
        if is_copied(model, k):
            copy_covariance(model, P)
        if (k + 1) % interval == 0 and is_repeated(P, before, tolerance):
            return i + 1, True
    return steps, False


@part
def is_repeated(P, before, tolerance):
    """Return whether P (N, N) is `before`, which is overwritten, but for the tolerance."""
    repeated = True
    for a in range(len(P)):
        for b in range(a + 1):
            # squares save roots; NaN counts as a difference
            far = (P[a, b] - before[a, b]) ** 2
            if not far <= tolerance**2 * P[a, a] * P[b, b]:
                repeated = False
            before[a, b] = P[a, b]
    return repeated


@part
def predict_covariance(model, P):
    """Replace the covariance P (N, N) of a step by the predicted covariance of the next step.

    Each block of two rows and two columns is moved on once and written to both of its places, so P
    stays exactly symmetric.
    """
    A, Q = model.A, model.Q
    n, N = len(Q), len(P)
    for one in range(n // 2):
        i = 2 * one
        a, b, c, d = A[one, 0, 0], A[one, 0, 1], A[one, 1, 0], A[one, 1, 1]
        for two in range(one + 1):
            j = 2 * two
            e, f, g, h = A[two, 0, 0], A[two, 0, 1], A[two, 1, 0], A[two, 1, 1]
            # B = A_i P_ij, then B A_j'
            b00, b01 = a * P[i, j] + b * P[i + 1, j], a * P[i, j + 1] + b * P[i + 1, j + 1]
            b10, b11 = c * P[i, j] + d * P[i + 1, j], c * P[i, j + 1] + d * P[i + 1, j + 1]
            P[i, j] = e * b00 + f * b01 + Q[i, j]
            P[i, j + 1] = g * b00 + h * b01 + Q[i, j + 1]
            P[i + 1, j] = e * b10 + f * b11 + Q[i + 1, j]
            P[i + 1, j + 1] = g * b10 + h * b11 + Q[i + 1, j + 1]
            P[j, i], P[j, i + 1] = P[i, j], P[i + 1, j]
            P[j + 1, i], P[j + 1, i + 1] = P[i, j + 1], P[i + 1, j + 1]
        for k in range(n, N):
            first, second = P[i, k], P[i + 1, k]
            P[i, k] = P[k, i] = a * first + b * second
            P[i + 1, k] = P[k, i + 1] = c * first + d * second
    if model.reds > 0:
        for j in range(N):
            P[n + 1, j] *= model.fade
            P[j, n + 1] *= model.fade
        P[n + 1, n + 1] += model.red
    P[n, n] += model.walk


@part
def apply_fast(model, P, gain):
    """Correct the covariance P (N, N) by the fast measurement; write its gain to `gain` (N,)."""
    n, row = len(model.Q), model.fast
    multiply(P, row, gain)
    for i in range(len(P)):
        gain[i] += P[n, i]
    variance = model.r_fast + gain[n]
    for i in range(n):
        variance += row[i] * gain[i]
    correct_covariance(P, gain, variance)


@part
def multiply(P, row, product):
    """Write P (N, N) times a row (n,) of the shaping filter's states to `product`, (N,) or (n,)."""
    for i in range(len(product)):
        product[i] = 0.0
    for j in range(0, len(row), 2):  # P is symmetric, and its rows lie side by side
        for i in range(len(product)):
            product[i] += row[j] * P[j, i] + row[j + 1] * P[j + 1, i]


@njit
def apply_slow(model, P, gain):
    """Correct P (N, N) by a slow measurement; return the variance of its innovation.

    The gain is written to `gain` (N,).
    """
    variance = find_slow_column(model, P, gain)
    correct_covariance(P, gain, variance)
    return variance


@part
def find_slow_column(model, P, column):
    """Write P h' (N,) to `column`, where h is the slow measurement's row; return h P h' + r."""
    n, N, row = len(model.Q), len(P), model.slow
    if model.copies > 0:
        for i in range(N):
            column[i] = P[i, N - 1]
    else:
        multiply(P, row, column)
    if model.reds > 0:
        for i in range(N):
            column[i] += P[i, n + 1]
    variance = model.r_slow
    if model.copies > 0:
        variance += column[N - 1]
    else:
        for i in range(n):
            variance += row[i] * column[i]
    if model.reds > 0:
        variance += column[n + 1]
    return variance


@part
def correct_covariance(P, gain, variance):
    """Correct the covariance P (N, N) by a measurement of one number, in place.

    gain: the column P h' (N,), where h is the measurement's row; overwritten by the gain.
    variance: the innovation's variance h P h' + r.
    """
    N, root = len(P), np.sqrt(variance)
    for i in range(N):
        gain[i] /= root
    for i in range(N):
        row, scale = P[i], gain[i]
        for j in range(N):
            row[j] -= scale * gain[j]
    for i in range(N):
        gain[i] /= root


@part
def write_outputs(P, outputs, work, result):
    """Write the covariance of c outputs of a state with the covariance P (N, N) to `result` (c, c).

    `outputs` are the rows (c, n) of the outputs; `work` is an array (n,) that is overwritten.
    """
    count, n = outputs.shape
    for b in range(count):
        multiply(P, outputs[b], work)
        for a in range(b + 1):
            total = 0.0
            for i in range(n):
                total += outputs[a, i] * work[i]
            result[a, b] = total
            result[b, a] = total


@njit
def is_copied(model, step):
    """Return whether a slow measurement will report the output of this step."""
    return model.copies > 0 and (step + model.delay) % model.interval == 0


@part
def copy_covariance(model, P):
    """Make the present output the newest copy in the covariance P (N, N); drop the oldest copy."""
    n, N, row = len(model.Q), len(P), model.slow
    new = n + 1 + model.reds
    for i in range(N - 1, new, -1):
        for j in range(N):
            P[i, j] = P[i - 1, j]
    for i in range(N - 1, new, -1):
        for j in range(N):
            P[j, i] = P[j, i - 1]
    multiply(P, row, P[new])
    P[:, new] = P[new]
    P[new, new] = 0.0
    for i in range(n):
        P[new, new] += row[i] * P[i, new]


class LateState(NamedTuple):
    """The state of filters that run side by side, one lane each.

    x: N rows with the field x, one number per lane.
    step: one row for the step that is being computed: r and odd, two sums that make the innovation;
        p and v, the outputs.
    """

    x: Rows
    step: Rows


def start_lanes(states: int, lanes: int) -> LateState:
    """Make the state, all zero, of filters with `states` numbers that run side by side."""
    return LateState(make_rows(states, lanes, "x"), make_rows(1, lanes, "odd", "r", "p", "v"))


class LateEstimates(NamedTuple):
    """What filters that run side by side make of the measurements of some steps.

    outputs, covariance: the two outputs, shape (steps, 2, lanes), and the covariance of each
        lane's, (steps, 2, 2).
    innovation, variance: innovations of the slow measurements, shape (fixes, lanes), and their
        variance, shape (fixes,).
    """

    outputs: Array
    covariance: Array
    innovation: Array
    variance: Array


def prepare_estimates(steps: int, fixes: int, lanes: int) -> LateEstimates:
    """Make the arrays for estimates of some steps, at which some slow measurements are due."""
    return LateEstimates(
        np.empty((steps, 2, lanes)), np.empty((steps, 2, 2)), np.full((fixes, lanes), np.nan),
        np.empty(fixes),
    )  # fmt: skip


@njit
def follow(first, force, fixes, column, model, outputs, rows, state, filled):
    """Run the filter on some lanes, with gains that are computed before.

    first: number of the first step.
    force, fixes: fast measurements, one row per step, and slow ones, one row for each that is due;
        those of the first lane are in column `column`, those of the others beside it.
    model, outputs, rows, state: the `LateModel`, the rows (2, n) of its two outputs, `LateRows`,
        and `LateState`. After the last of `rows`, those of the last interval repeat.
    filled: the `LateEstimates` to fill.
    """
    A, h, C, copies, interval = model.A, model.fast, outputs, model.copies, model.interval
    fast, slow, variance, covariance = rows.fast, rows.slow, rows.variance, rows.outputs
    X, t = state.x, state.step[0]
    n, N, count, last = len(h), len(X), len(fast), len(slow) - 1
    new = n + 1 + model.reds
    since, to_copy = first % interval, (interval - (first + model.delay) % interval) % interval
    row = schedule_row(first, count, interval)
    number, q = min((row + interval - 1) // interval, last), 0
    for k in range(len(force)):
        clear(t)
        for i in range(n // 2):
            predict_pair(X[2 * i], X[2 * i + 1], A, i, h, t)
        if model.reds > 0:
            fade(X[n + 1], model.fade)
        add_term(t.r, X[n], 1.0)
        subtract_from(t, force, k, column)
        for i in range(N):
            correct(X[i], t, fast[row, i])
        if since == 0:
            filled.variance[q] = variance[number]
            clear(t)
            if copies > 0:
                add_term(t.r, X[N - 1], 1.0)
            else:
                for i in range(n):
                    add_term(t.r, X[i], C[0, i])
            if model.reds > 0:
                add_term(t.r, X[n + 1], 1.0)
            subtract_from(t, fixes, q, column)
            for i in range(N):
                correct(X[i], t, slow[number, i])
            for j in range(len(t.r)):
                filled.innovation[q, j] = t.r[j]
            number, q = min(number + 1, last), q + 1
        for i in range(n):
            add_term(t.p, X[i], C[0, i])
            add_term(t.v, X[i], C[1, i])
        for j in range(len(t.p)):
            filled.outputs[k, 0, j], filled.outputs[k, 1, j] = t.p[j], t.v[j]
        for i in range(2):
            for j in range(2):
                filled.covariance[k, i, j] = covariance[row, i, j]
        if to_copy == 0:
            for i in range(N - 1, new, -1):
                X[i] = X[i - 1]
            if copies > 0:
                for j in range(len(t.p)):
                    X[new].x[j] = t.p[j]
            to_copy = interval
        to_copy -= 1
        since = since + 1 if since + 1 < interval else 0
        row = row + 1 if row + 1 < count else count - interval


@part
def clear(t):
    """Set a step's sums to zero."""
    for j in range(len(t.r)):
        t.r[j] = t.odd[j] = t.p[j] = t.v[j] = 0.0


@part
def predict_pair(one, two, A, i, h, t):
    """Move two states on by block i of A; add what they make of the fast measurement."""
    a00, a01, a10, a11 = A[i, 0, 0], A[i, 0, 1], A[i, 1, 0], A[i, 1, 1]
    h0, h1 = h[2 * i], h[2 * i + 1]
    for j in range(len(t.r)):
        first = a00 * one.x[j] + a01 * two.x[j]
        second = a10 * one.x[j] + a11 * two.x[j]
        one.x[j], two.x[j] = first, second
        t.r[j] += h0 * first
        t.odd[j] += h1 * second


@part
def fade(x, factor):
    """Multiply a state by a factor."""
    for j in range(len(x.x)):
        x.x[j] *= factor


@part
def add_term(total, x, c):
    """Add a state times c to a sum."""
    for j in range(len(total)):
        total[j] += c * x.x[j]


@part
def subtract_from(t, measured, at, column):
    """Make the innovation: r = z - (r + odd), where z stands in row `at` of the measurements."""
    for j in range(len(t.r)):
        t.r[j] = measured[at, column + j] - (t.r[j] + t.odd[j])


@part
def correct(x, t, gain):
    """Correct a state by its gain times the innovation: x = x + K r."""
    for j in range(len(t.r)):
        x.x[j] += gain * t.r[j]
