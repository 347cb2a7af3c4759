"""Runs one estimator sample by sample, with gains for the measurements that really arrived.

These kernels serve all four schemes on two axes. All parts but the filter are recomputed from their
registers at every step, so rounding errors do not accumulate. Memory is constant: registers have
one row per step, and when they are full, the newest rows are moved to the front. In all kernels f,
h and m are `FilterSettings`, `HorizonSettings` and `OnlineRegisters`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit, part
from owtsweep.estimation.riccati import MASK_ROWS, TwoRates, multiply, riccati_step
from owtsweep.estimation.weighing import weigh
from owtsweep.estimation.windowing import FilterRows, covariances
from owtsweep.studies.hub.kernels.chain import (
    add_correction,
    add_innovation,
    carry_back,
    clear,
    correct,
    predict,
    predict_and_correct,
    sum_inputs,
)
from owtsweep.studies.hub.kernels.online_layout import BEYOND, PICK, ROW, STEP
from owtsweep.studies.hub.kernels.window import (
    after_filter,
    distance,
    horizon_has_position,
    horizon_position,
    put,
    take,
    take_fix,
)


@njit
def advance(begin, resume, samples, f, h, m, estimates):
    """Process the samples from row `begin` on and fill the rows of `OnlineEstimates`, NaN so far.

    Return the number of rows when all are done. If the MHE violates its constraints at a row,
    return the number of this row. The caller then solves the window with its constraints, puts the
    position into m.given (at a fix, also the state into m.node), and calls again, from this row,
    with `resume` set. Samples are the specific force (steps, 2), m/s^2 in the IMU's frame, and the
    position fixes (steps, 2), m in NED; NaN for a missing fix.
    """
    force, fixes = samples
    state, covariance, innovation, variance = estimates
    rows = len(force)
    for i in range(begin, rows):
        fresh = not np.isnan(fixes[i, 0])
        if not resume:
            take_sample(force[i], f, m)
            if h.active:
                if m.counter[STEP] % f.fix_interval == 0:
                    take_fix(fresh, fixes[i], f, h, m)
                if not horizon_position(f, h, m):
                    return i
            elif fresh:
                m.given[0, 0], m.given[0, 1] = fixes[i, 0], fixes[i, 1]
        resume = False
        if h.active:
            fresh = horizon_has_position(f, h, m)
        ss = filter_step(fresh, f, m)
        if h.active:
            after_filter(f, h, m)
        output(f, m, state[i], covariance[i])
        if fresh:
            variance[i] = ss
            for axis in range(2):
                innovation[i, axis] = m.steps[m.counter[ROW]].s[axis]
        m.counter[STEP] += 1
    return rows


@part
def take_sample(force, f, m):
    """Turn the newest specific force (2,) to NED; store it in m.force, register 1 of the paper.

    If the registers are full, the newest rows of all are first moved to the front.
    """
    row = m.counter[ROW] + 1
    keep = f.delay + f.window + 2
    if row == len(m.force):
        for i in range(keep):
            old = row - keep + i
            m.force[i, 0], m.force[i, 1] = m.force[old, 0], m.force[old, 1]
            m.steps[i] = m.steps[old]
            for register in (m.K, m.C, m.Pm, m.Pf):
                put(register[i], 0, 0, register[old])
        row = keep
    for i in range(2):
        m.force[row, i] = f.rotation[i, 0] * force[0] + f.rotation[i, 1] * force[1]
    m.counter[ROW] = row


@part
def filter_step(fresh, f, m):
    """Run one step of the Kalman filter (Algorithm 6 of Ren et al. 2019), gain included.

    `fresh` says whether m.given holds a position of this step. Return the variance of its
    innovation along an axis, m^2.
    """
    row = m.counter[ROW]
    before, now, at = m.steps[row - 1], m.steps[row], row - f.delay
    rates = f.rates
    taken, r_slow, judged = fresh, rates.r_slow, 0.0
    if fresh and f.fix_rule.limit < np.inf:
        # the gains are not known yet, but the predicted position does not depend on them
        predict_and_correct(before, now, m.force, at, f, m.K, row)
        for axis in range(2):
            m.predicted[0, axis] = now.s[axis]
        judged = predicted_variance(f, m) + r_slow
        far = distance(m.given[0], m.predicted, judged)
        weight = weigh(far, f.fix_rule, m.counter[BEYOND : BEYOND + 1])
        taken = weight > 0.0
        if taken:
            r_slow += (1.0 / weight - 1.0) * judged  # the innovation's becomes judged / weight
    model = TwoRates(f.A, rates.Q, rates.slow, f.h, r_slow, rates.r_fast, rates.rule)
    ss = riccati_step(model, m.P, taken, m.K[row], m.Pm[row], m.Pf[row], m.work)
    if judged > 0.0:
        ss = judged
    put(m.P, 0, 0, m.Pf[row])
    if not taken and rates.rule != MASK_ROWS:
        for i in range(4):
            m.K[row, i, 0] = 0.0
    predict_and_correct(before, now, m.force, at, f, m.K, row)
    correct(now, m.given, 0, m.K, row)
    return ss


@part
def predicted_variance(f, m):
    """Return the variance of the predicted position along an axis, m^2; change nothing."""
    total = f.rates.Q[0, 0]
    for i in range(4):
        for j in range(4):
            total += f.A[0, i] * m.P[i, j] * f.A[0, j]
    return total


@njit
def output(f, m, state, covariance):
    """Smooth and predict (Algorithms 8 and 9 of Ren et al. 2019); write the present estimate.

    x, y, v_x, v_y are written to `state` (4,), the covariance of position and velocity along an
    axis to `covariance` (2, 2). Without a predictor, the filter's state is the estimate.
    """
    row, k, window = m.counter[ROW], m.counter[STEP], f.window
    if not f.predicts:
        write(m.steps[row], state)
        take(covariance, m.P, 0, 0)
        return
    if window > 0 and k > 0:
        smoother_gain(f.A, m.Pf[row - 1], m.Pm[row], m.work, m.C[row - 1])
    x, S, sums = m.estimate[0], m.back[0], m.inputs[0]
    clear(x)
    if k >= window:  # until then the smoother's register is not full
        clear(S)
        for j in range(row, row - window, -1):
            add_innovation(S, m.steps[j].s, m.K, j, 0)
            add_innovation(S, m.steps[j].r, m.K, j, 1)
            carry_back(S, m.C, j - 1)
        add_correction(x, m.steps[row - window])
        add_correction(x, S)
    sum_inputs(sums, m.force, row, f.predictor)
    predict(x, sums, m.force, row, f.predictor)
    write(x, state)
    output_covariance(f, m, covariance)


@part
def write(x, state):
    """Write a state's positions and velocities to `state` (4,)."""
    for axis in range(2):
        state[axis], state[2 + axis] = x.p[axis], x.v[axis]


@njit
def smoother_gain(A, filtered, predicted, work, C):
    """Compute the smoother's gain C = P_{k|k} A' P_{k+1|k}^-1 by Gaussian elimination.

    `filtered` is P_{k|k}, `predicted` is P_{k+1|k}; all matrices are (n, n). `work` is memory for
    at least two. There is no pivoting, since covariances do not need it.
    """
    n = len(A)
    M, X = work[0], work[1]
    put(M, 0, 0, predicted)
    multiply(A, filtered, X)
    for c in range(n):
        for i in range(c + 1, n):
            factor = M[i, c] / M[c, c]
            for j in range(c, n):
                M[i, j] -= factor * M[c, j]
            for j in range(n):
                X[i, j] -= factor * X[c, j]
    for i in range(n - 1, -1, -1):
        for j in range(n):
            total = X[i, j]
            for m in range(i + 1, n):
                total -= M[i, m] * C[j, m]
            C[j, i] = total / M[i, i]


@njit
def output_covariance(f, m, covariance):
    """Write the covariance (2, 2) of predicted position and velocity, equal for both axes.

    `hub.chain` uses the same formula for the batch engine.
    """
    row, window = m.counter[ROW], f.window
    if f.delay + window == 0:
        take(covariance, m.P, 0, 0)
        return
    smoothed, coupling = m.smoothed, m.coupling
    if m.counter[STEP] >= window:
        begin = row - window
        rows = FilterRows(m.Pf[begin : row + 1], m.Pm[begin : row + 1], m.C[begin : row + 1])
        covariances(rows, window, f.h, f.response, smoothed, coupling)
        P, cross = smoothed[window], coupling[window]
    else:
        P, cross = f.P0, m.no_coupling
    for a in range(2):
        for b in range(2):
            total = f.added[a, b]
            for i in range(3):
                total += f.ahead[a, i] * cross[PICK[i], b] + f.ahead[b, i] * cross[PICK[i], a]
                for j in range(3):
                    total += f.ahead[a, i] * P[PICK[i], PICK[j]] * f.ahead[b, j]
            covariance[a, b] = total
