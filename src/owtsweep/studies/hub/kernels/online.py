"""Runs one estimator sample by sample, with gains for the measurements that really arrived.

These kernels serve all four schemes on two axes. All parts but the filter are recomputed from their
registers at every step, so rounding errors do not accumulate. Memory is constant: registers have
one row per step, and when they are full, the newest rows are moved to the front. In all kernels f,
h and m are `FilterSettings`, `HorizonSettings` and `OnlineRegisters`. Smoother and predictor are in
`online_output`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit, part
from owtsweep.estimation.riccati import MASK_ROWS, TwoRates, riccati_step
from owtsweep.studies.hub.kernels.filtering import correct, predict_and_correct
from owtsweep.studies.hub.kernels.horizon import (
    FIXED,
    NO_ARRIVAL,
    PRIOR,
    choose_input,
    older_nodes,
    put,
    solve_window,
    square_root_information,
    violates,
)
from owtsweep.studies.hub.kernels.online_layout import (
    BEYOND,
    DETERMINED,
    GATE,
    HUBER,
    LEAST_CHANGE,
    LINKS,
    MOST_WEIGHINGS,
    PICK,
    PLAIN,
    ROW,
    STEP,
)
from owtsweep.studies.hub.kernels.online_output import output
from owtsweep.studies.hub.kernels.predicting import add_input


@njit
def distance(fix, state, variance):
    """Return the distance of a fix (2,) from a state (states, 2), in standard deviations.

    `variance`, m^2, is that of the difference along each axis.
    """
    x, y = fix[0] - state[0, 0], fix[1] - state[0, 1]
    return np.sqrt((x * x + y * y) / variance)


@njit
def judge(far, settings, counter):
    """Return the weight, from 0 to 1, of a new fix that is `far` standard deviations away."""
    if far <= settings.fix_limit:
        counter[BEYOND] = 0
        return 1.0
    counter[BEYOND] += 1
    if settings.fix_rule == GATE:
        return 0.0 if counter[BEYOND] <= settings.fix_patience else 1.0
    return settings.fix_limit / far


@njit
def weigh_again(n, h, m):
    """Weigh the fixes of the MHE's window, of n links, by their distances from its nodes.

    The square roots of the weights go to m.weight. Return whether a weight changed by more than
    `LEAST_CHANGE`.
    """
    variance = 1.0 / (h.inverse_sigma * h.inverse_sigma)
    changed = 0.0
    for i in range(n + 1):
        if m.have[i]:
            far = distance(m.z[i], m.nodes[i], variance)
            weight = 1.0 if far <= h.fix_limit else h.fix_limit / far
            changed = max(changed, abs(weight - m.weight[i] * m.weight[i]))
            m.weight[i] = np.sqrt(weight)
    return changed >= LEAST_CHANGE


@njit
def advance(begin, resume, samples, f, h, m, estimates):
    """Process the samples from row `begin` on and fill the rows of `OnlineEstimates`.

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
        else:
            variance[i] = np.nan
            innovation[i, 0] = innovation[i, 1] = np.nan
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
    taken, r_slow, judged = fresh, f.r_slow, 0.0
    if fresh and f.fix_rule != PLAIN:
        # the gains are not known yet, but the predicted position does not depend on them
        predict_and_correct(before, now, m.force, at, f, m.K, row)
        for axis in range(2):
            m.predicted[0, axis] = now.s[axis]
        judged = predicted_variance(f, m) + f.r_slow
        weight = judge(distance(m.given[0], m.predicted, judged), f, m.counter)
        taken = weight > 0.0
        if taken:
            r_slow += (1.0 / weight - 1.0) * judged  # the innovation's becomes judged / weight
    model = TwoRates(f.A, f.Q, f.slow, f.h, r_slow, f.r_fast, f.rule)
    ss = riccati_step(model, m.P, taken, m.K[row], m.Pm[row], m.Pf[row], m.work)
    if judged > 0.0:
        ss = judged
    put(m.P, 0, 0, m.Pf[row])
    if not taken and f.rule != MASK_ROWS:
        for i in range(4):
            m.K[row, i, 0] = 0.0
    predict_and_correct(before, now, m.force, at, f, m.K, row)
    correct(now, m.given, 0, m.K, row)
    return ss


@part
def predicted_variance(f, m):
    """Return the variance of the predicted position along an axis, m^2; change nothing."""
    total = f.Q[0, 0]
    for i in range(4):
        for j in range(4):
            total += f.A[0, i] * m.P[i, j] * f.A[0, j]
    return total


@njit
def take_fix(fresh, fix, f, h, m):
    """Add a node to the MHE's window, with a fix (2,) if `fresh`; solve the window.

    It is solved only if its fixes determine its states. Nodes are kept in registers 2 and 3 of Ren
    et al. (2019).
    """
    n = m.counter[LINKS]
    if m.counter[STEP] > 0:
        if n == h.length:
            for i in range(n):
                m.have[i] = m.have[i + 1]
                m.z[i, 0], m.z[i, 1] = m.z[i + 1, 0], m.z[i + 1, 1]
                put(m.states[i], 0, 0, m.states[i + 1])
                put(m.covariances[i], 0, 0, m.covariances[i + 1])
                if i > 0:
                    put(m.effects[i - 1], 0, 0, m.effects[i])
        else:
            n += 1
            m.counter[LINKS] = n
        for axis in range(2):
            m.effects[n - 1, 0, axis] = m.now[0].p[axis]
            m.effects[n - 1, 1, axis] = m.now[0].v[axis]
            m.effects[n - 1, 2, axis] = 0.0
    for axis in range(2):
        m.now[0].p[axis] = m.now[0].v[axis] = 0.0
    m.have[n] = fresh
    for axis in range(2):
        m.z[n, axis] = fix[axis] if fresh else 0.0
    uses_filter = h.arrival != NO_ARRIVAL and m.counter[STEP] >= h.length * f.fix_interval
    first = 1 if uses_filter else 0
    there = 0
    for i in range(first, n + 1):
        there += m.have[i]
    m.counter[DETERMINED] = there >= (3 if h.arrival == NO_ARRIVAL else 1)
    if not m.counter[DETERMINED]:
        return
    kind = h.arrival
    x0, prior = m.zero, h.prior
    if uses_filter:
        x0 = m.states[0]
        if kind == PRIOR:
            square_root_information(m.covariances[0], m.prior)
            prior = m.prior
    elif kind == FIXED:
        kind = PRIOR  # while the window fills, its oldest state is uncertain
    for i in range(n + 1):
        m.weight[i] = 1.0
    solve_window(n, h, m, x0, prior, kind, first)
    if h.fix_rule == HUBER:
        for _ in range(MOST_WEIGHINGS):
            older_nodes(n, m.blocks, m.nodes)
            if not weigh_again(n, h, m):
                break
            solve_window(n, h, m, x0, prior, kind, first)
    put(m.node, 0, 0, m.nodes[n])
    if h.constrained:
        older_nodes(n, m.blocks, m.nodes)


@part
def horizon_has_position(f, h, m):
    """Return whether the MHE has a position for the filter at this step."""
    since = m.counter[STEP] % f.fix_interval
    if m.counter[DETERMINED]:
        return m.counter[STEP] % h.interval == 0
    return since == 0 and m.have[m.counter[LINKS]]


@part
def horizon_position(f, h, m):
    """Put the MHE's position, if there is one, into m.given; return whether constraints hold."""
    n = m.counter[LINKS]
    since = m.counter[STEP] % f.fix_interval
    if not m.counter[DETERMINED]:
        if since == 0 and m.have[n]:
            # too few fixes for a window: the filter gets the fix itself
            m.given[0, 0], m.given[0, 1] = m.z[n, 0], m.z[n, 1]
        return True
    if m.counter[STEP] % h.interval != 0:
        return True
    g = h.growth[since]
    last = m.nodes[n + 1]
    for axis in range(2):
        p, v, b = m.node[0, axis], m.node[1, axis], m.node[2, axis]
        last[0, axis] = p + g[0, 1] * v + g[0, 2] * b + m.now[0].p[axis] + g[0, 0] * p
        last[1, axis] = v + g[1, 2] * b + m.now[0].v[axis] + (g[1, 0] * p + g[1, 1] * v)
        last[2, axis] = b
        m.given[0, axis] = last[0, axis]
    if h.constrained:
        if since > 0:  # the nodes at fixes were checked, and solved again, at the last fix
            # with a tolerance: this node is predicted from one that may be on its bound
            return not violates(last, h.bounds * (1.0 + 1e-8), f.rotation, f.gravity)
        start = 1 if h.arrival == FIXED and m.counter[STEP] >= h.length * f.fix_interval else 0
        for i in range(start, n + 1):
            if violates(m.nodes[i], h.bounds, f.rotation, f.gravity):
                return False
    return True


@part
def after_filter(f, h, m):
    """Store the filter's state for the MHE, and integrate this step's specific force.

    State and covariance go to register 3 of Ren et al. (2019), but only at steps at which a fix may
    come. The force is integrated as the MHE takes it: all samples, averaged or sampled.
    """
    n, x = m.counter[LINKS], m.steps[m.counter[ROW]]
    if m.counter[STEP] % f.fix_interval == 0:
        for i in range(3):
            for axis in range(2):
                m.states[n, i, axis] = (x.p[axis], x.v[axis], x.b[axis])[i]
            for j in range(3):
                m.covariances[n, i, j] = m.P[PICK[i], PICK[j]]
    now, u = m.now[0], m.force[m.counter[ROW] - f.delay]
    choose_input(now, u, h.inputs, m.counter[STEP] % h.interval == 0, h.interval)
    add_input(now, now.sample, h.step, 0.5 * h.step * h.step, h.lean)
