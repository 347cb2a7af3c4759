"""The moving horizon estimator of HME2, Eq. (11) of Ren et al. (2019), without constraints.

Its least squares problem is linear. So the state at the newest fix is a matrix times the window's
data: fixes, what the inputs between them add to position and velocity, and an arrival state. The
window (`Memory.nodes`) is registers 2 and 3 of the paper, Algorithms 4 and 5. `take_fix` and
`make_position` do so for many series.

If fixes are missing or weighed, the window is solved again, by a square-root information filter
(`solve_window`): one QR step over each link yields a block of factors for the older node and a 3 x
3 factor for the newer node. Both axes share the factors.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit, part
from owtsweep.studies.hub.kernels.layout import ALL, AVERAGED


@part
def add_datum(now, values, maps, matrix, column):
    """Add a datum's part of the state at the newest fix: a column of the matrix times the datum."""
    g0, g1, g2 = maps[matrix, 0, column], maps[matrix, 1, column], maps[matrix, 2, column]
    for i in range(len(now.np)):
        now.np[i] += g0 * values[i]
        now.nv[i] += g1 * values[i]
        now.nb[i] += g2 * values[i]


@part
def take_fix(q, fixes, mhe, nodes, now):
    """Take fix number q into the window, and compute the state np, nv, nb at this fix.

    Before fix number mhe.first no state is computed. The arguments are `Fed.fixes`,
    `HorizonArrays`, `Memory.nodes` and the row of `Memory.now`.
    """
    size, n = len(nodes), min(q, mhe.horizon)
    last, new = nodes[(q - 1) % size], nodes[q % size]
    for i in range(len(now.p)):
        if q > 0:
            last.ip[i], last.iv[i] = now.p[i], now.v[i]
        new.z[i] = fixes[q, i]
        now.p[i] = now.v[i] = now.np[i] = now.nv[i] = now.nb[i] = 0.0
    if q < mhe.first:
        return
    maps, matrix = mhe.maps, min(q, len(mhe.maps) - 1)
    for j in range(n + 1):
        add_datum(now, nodes[(q - n + j) % size].z, maps, matrix, j)
    for j in range(n):  # three columns each; an input does not change the bias
        node = nodes[(q - n + j) % size]
        add_datum(now, node.ip, maps, matrix, n + 1 + 3 * j)
        add_datum(now, node.iv, maps, matrix, n + 2 + 3 * j)
    if mhe.arrival and q >= mhe.horizon:
        node = nodes[(q - n) % size]
        add_datum(now, node.p, maps, matrix, 4 * n + 1)
        add_datum(now, node.v, maps, matrix, 4 * n + 2)
        add_datum(now, node.b, maps, matrix, 4 * n + 3)


@part
def keep_state(x, node):
    """Keep the filter's state after a fix's correction, the row x, in the fix's node (Alg. 5)."""
    for i in range(len(x.p)):
        node.p[i], node.v[i], node.b[i] = x.p[i], x.v[i], x.b[i]


@part
def make_position(growth, since, now, position):
    """Predict the MHE's position `since` steps after the last fix, by A_df and B_df (Eq. 11d)."""
    gp, gv, gb = growth[since, 0, 0], growth[since, 0, 1], growth[since, 0, 2]
    for i in range(len(now.p)):
        n = now.np[i]
        position[0, i] = n + gv * now.nv[i] + gb * now.nb[i] + now.p[i] + gp * n


@part
def choose_input(now, u, inputs, tick, interval):
    """Set now.sample to the input that the MHE takes: each, the average or one of `interval`.

    u are the lanes' specific forces; `tick` says whether the step is a multiple of `interval`.
    """
    if inputs == ALL:
        for i in range(len(now.p)):
            now.sample[i] = u[i]
        return
    for i in range(len(now.p)):
        now.gathered[i] += u[i]
    if tick:
        for i in range(len(now.p)):
            now.sample[i] = now.gathered[i] / float(interval) if inputs == AVERAGED else u[i]
            now.gathered[i] = 0.0


#: What is known about the oldest node: nothing, a prior, or the state itself.
NO_ARRIVAL, PRIOR, FIXED = 0, 1, 2


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
