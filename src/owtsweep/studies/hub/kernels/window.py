"""The window of the online MHE, Eq. (11) of Ren et al. (2019), with the fixes that really came.

The least squares problem is solved by a square-root information filter (`solve_window`): one QR
step over each link yields a block of factors for the older node and a 3 x 3 factor for the newer
node. Both axes share the factors. Nodes are kept in registers 2 and 3 of the paper (`take_fix`,
`after_filter`). f, h and m are `FilterSettings`, `HorizonSettings` and `OnlineRegisters`.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit, part
from owtsweep.studies.hub.kernels.chain import add_input
from owtsweep.studies.hub.kernels.horizon import choose_input
from owtsweep.studies.hub.kernels.online_layout import (
    DETERMINED,
    LEAST_CHANGE,
    LINKS,
    MOST_WEIGHINGS,
    PICK,
    ROW,
    STEP,
)

#: What is known about the oldest node: nothing, a prior, or the state itself.
NO_ARRIVAL, PRIOR, FIXED = 0, 1, 2


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
    if h.fix_rule.fades:
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
    if not horizon_has_position(f, h, m):
        return True
    n = m.counter[LINKS]
    since = m.counter[STEP] % f.fix_interval
    if not m.counter[DETERMINED]:
        # too few fixes for a window: the filter gets the fix itself
        m.given[0, 0], m.given[0, 1] = m.z[n, 0], m.z[n, 1]
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
            weight = 1.0 if far <= h.fix_rule.limit else h.fix_rule.limit / far
            changed = max(changed, abs(weight - m.weight[i] * m.weight[i]))
            m.weight[i] = np.sqrt(weight)
    return changed >= LEAST_CHANGE


@njit
def distance(fix, state, variance):
    """Return the distance of a fix (2,) from a state (states, 2), in standard deviations.

    `variance`, m^2, is that of the difference along each axis.
    """
    x, y = fix[0] - state[0, 0], fix[1] - state[0, 1]
    return np.sqrt((x * x + y * y) / variance)


@njit
def solve_window(n, h, m, x0, prior, kind, first):
    """Solve a window of n links; write the newest node's state to m.nodes[n].

    A state is (3, 2): position, velocity and bias of both axes. For the older nodes only factors
    are left in m.blocks, from which `older_nodes` computes their states. The data must determine
    the states.

    h: the weights of the least squares problem, `HorizonSettings`.
    m: the fixes, the effects of the inputs, and memory for factors and nodes: `OnlineRegisters`.
    x0, prior: the arrival state (3, 2), and the square root (3, 3) of its information matrix.
    kind: what is known about the oldest node: NO_ARRIVAL (nothing), PRIOR (x0 with uncertainty) or
        FIXED (its state is x0).
    first: the fixes of nodes before number `first` are left out.
    """
    A, U, inverse_sigma = h.transition, h.link, h.inverse_sigma
    z, have, effects, blocks, nodes = m.z, m.have, m.effects, m.blocks, m.nodes
    weight = m.weight
    R = np.zeros((3, 3))
    r = np.zeros((3, 2))
    step = np.empty((6, 8))
    row = np.empty((4, 5))
    if kind == PRIOR:
        for i in range(3):
            for j in range(3):
                R[i, j] = prior[i, j]
                for axis in range(2):
                    r[i, axis] += prior[i, j] * x0[j, axis]
    for node in range(n + 1):
        if have[node] and node >= first:
            put(row, 0, 0, R)
            put(row, 0, 3, r)
            root = weight[node] * inverse_sigma
            row[3, 0] = root
            row[3, 1] = 0.0
            row[3, 2] = 0.0
            row[3, 3] = root * z[node, 0]
            row[3, 4] = root * z[node, 1]
            triangularise(row, 3)
            take(R, row, 0, 0)
            take(r, row, 0, 3)
        if node == n:
            break
        step[:] = 0.0
        if kind == FIXED and node == 0:
            for i in range(3):
                step[i, i] = 1.0  # stands for an infinite factor: the state is met exactly
            put(step, 0, 6, x0)
        else:
            put(step, 0, 0, R)
            put(step, 0, 6, r)
        for i in range(3):
            for j in range(3):
                step[3 + i, 3 + j] = U[i, j]
                for m in range(3):
                    step[3 + i, j] -= U[i, m] * A[m, j]
                for axis in range(2):
                    step[3 + i, 6 + axis] += U[i, j] * effects[node, j, axis]
        if kind == FIXED and node == 0:
            for i in range(3):
                for j in range(3):
                    for axis in range(2):
                        step[3 + i, 6 + axis] -= step[3 + i, j] * x0[j, axis]
        else:
            triangularise(step, 3)
        take(blocks[node], step, 0, 0)
        take(R, step, 3, 3)
        take(r, step, 3, 6)
    put(row, 0, 0, R)
    put(row, 0, 3, r)
    for j in range(5):
        row[3, j] = 0.0
    triangularise(row, 3)
    for axis in range(2):
        for i in range(2, -1, -1):
            total = row[i, 3 + axis]
            for j in range(i + 1, 3):
                total -= row[i, j] * nodes[n, j, axis]
            nodes[n, i, axis] = total / row[i, i]


@njit
def older_nodes(n, blocks, nodes):
    """Compute the states of the nodes n - 1 ... 0 from the state of node n, by back substitution.

    `blocks`, shape (n or more, 3, 8), are the factors that `solve_window` leaves. `nodes`, shape
    (n + 1 or more, 3, 2), holds the state of node n and gets the others.
    """
    for node in range(n - 1, -1, -1):
        block = blocks[node]
        for axis in range(2):
            for i in range(2, -1, -1):
                total = block[i, 6 + axis]
                for j in range(3):
                    total -= block[i, 3 + j] * nodes[node + 1, j, axis]
                for j in range(i + 1, 3):
                    total -= block[i, j] * nodes[node, j, axis]
                nodes[node, i, axis] = total / block[i, i]


@njit
def violates(x, bounds, rotation, gravity):
    """Return whether a node's state x (3, 2) breaks a constraint on either axis.

    The bounds (3,) apply to the magnitudes of position and velocity in NED and of the bias b^b in
    the IMU's frame; the state has x4 = -R b^b + g (Eq. 6 of Ren et al. 2019). `rotation` is R
    (2, 2), `gravity` is g (2,) in NED, m/s^2.
    """
    for axis in range(2):
        bias = 0.0  # b^b = R' (g - x4), Eq. (6)
        for j in range(2):
            bias += rotation[j, axis] * (gravity[j] - x[2, j])
        if abs(x[0, axis]) > bounds[0] or abs(x[1, axis]) > bounds[1] or abs(bias) > bounds[2]:
            return True
    return False


@njit
def triangularise(M, columns):
    """Make M (rows, width) triangular in its first columns by Householder reflections, in place."""
    rows, width = M.shape
    for c in range(min(columns, rows - 1)):
        norm = 0.0
        for i in range(c, rows):
            norm += M[i, c] * M[i, c]
        norm = np.sqrt(norm)
        if norm == 0.0:
            continue
        alpha = -norm if M[c, c] > 0.0 else norm
        head = M[c, c] - alpha
        beta = -1.0 / (alpha * head)  # 2 / v'v
        for j in range(c + 1, width):
            total = head * M[c, j]
            for i in range(c + 1, rows):
                total += M[i, c] * M[i, j]
            total *= beta
            M[c, j] -= total * head
            for i in range(c + 1, rows):
                M[i, j] -= total * M[i, c]
        M[c, c] = alpha
        for i in range(c + 1, rows):
            M[i, c] = 0.0


@njit
def square_root_information(P, U):
    """Fill U (3, 3) with the inverse of the Cholesky factor of P (3, 3), so that U' U = P^-1."""
    L = np.zeros((3, 3))
    for i in range(3):
        for j in range(i + 1):
            total = P[i, j]
            for m in range(j):
                total -= L[i, m] * L[j, m]
            L[i, j] = np.sqrt(total) if i == j else total / L[j, j]
    for j in range(3):
        for i in range(3):
            total = 1.0 if i == j else 0.0
            for m in range(i):
                total -= L[i, m] * U[m, j]
            U[i, j] = total / L[i, i]


@njit
def put(target, row, column, source):
    """Copy the matrix `source` into a larger one, from a row and a column of `target` on.

    (numba takes seconds to compile an assignment of slices.)
    """
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[row + i, column + j] = source[i, j]


@njit
def take(target, source, row, column):
    """Fill the matrix `target` with the part of `source` that begins at a row and a column."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[row + i, column + j]
