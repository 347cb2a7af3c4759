"""The moving horizon estimator of HME2 on many lanes, Eq. (11) of Ren et al. (2019).

Without constraints its least squares problem is linear. So the state at the newest fix is a matrix
times the window's data: fixes, what the inputs between them add to position and velocity, and an
arrival state. The window (`Memory.nodes`) is registers 2 and 3 of the paper, Algorithms 4 and 5.
"""

from __future__ import annotations

from owtsweep.compiled import part
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
