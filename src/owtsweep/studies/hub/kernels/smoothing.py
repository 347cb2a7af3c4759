"""The online smoother, Algorithm 8 of Ren et al. (2019), in O(1) operations per step.

With the innovations i_k = (s, r) of position and specific force, the corrections e_k = K_k i_k and
the smoother's gains C_k and D_k, the smoothed state is x_{k|k} + S_k, where S_k = C_k (e_{k+1} +
S_{k+1} + D_{k+1} i_{k+1+window}): step k + 1 enters the sum, step k + 1 + window leaves it. This
recursion is stable backwards in time only. So each chunk starts it again, one window after the
chunk's last state; inside this window nothing leaves.
"""

from __future__ import annotations

from owtsweep.compiled import part
from owtsweep.estimation.windowing import schedule_row


@part
def row_before(k, row, rows, cycle):
    """Return the gain schedule's row of step k - 1, if `row` is that of step k."""
    return rows - 1 if row == rows - cycle and k > row else row - 1


@part
def add_position(S, x, G, row):
    """Add a position's part of a correction: S = S + G s, where s is the innovation in the row x.

    G are the filter's gains K or the smoother's D, of which the gains of the given row are used.
    """
    g0, g1, g2, g3 = G[row, 0, 0], G[row, 1, 0], G[row, 2, 0], G[row, 3, 0]
    for i in range(len(S.p)):
        s = x.s[i]
        S.p[i] += g0 * s
        S.v[i] += g1 * s
        S.a[i] += g2 * s
        S.b[i] += g3 * s


@part
def add_force(S, x, G, row):
    """Add a specific force's part of a correction: S = S + G r, where r stands in the row x."""
    g0, g1, g2, g3 = G[row, 0, 1], G[row, 1, 1], G[row, 2, 1], G[row, 3, 1]
    for i in range(len(S.p)):
        r = x.r[i]
        S.p[i] += g0 * r
        S.v[i] += g1 * r
        S.a[i] += g2 * r
        S.b[i] += g3 * r


@part
def carry_back(S, C, row):
    """Turn a correction of one step's state into that of the step before: S = C S."""
    c00, c01, c02, c03 = C[row, 0, 0], C[row, 0, 1], C[row, 0, 2], C[row, 0, 3]
    c10, c11, c12, c13 = C[row, 1, 0], C[row, 1, 1], C[row, 1, 2], C[row, 1, 3]
    c20, c21, c22, c23 = C[row, 2, 0], C[row, 2, 1], C[row, 2, 2], C[row, 2, 3]
    c30, c31, c32, c33 = C[row, 3, 0], C[row, 3, 1], C[row, 3, 2], C[row, 3, 3]
    for i in range(len(S.p)):
        p, v, a, b = S.p[i], S.v[i], S.a[i], S.b[i]
        S.p[i] = c00 * p + c01 * v + c02 * a + c03 * b
        S.v[i] = c10 * p + c11 * v + c12 * a + c13 * b
        S.a[i] = c20 * p + c21 * v + c22 * a + c23 * b
        S.b[i] = c30 * p + c31 * v + c32 * a + c33 * b


@part
def add_correction(x, S):
    """Smooth a step's state: x = x + S."""
    for i in range(len(S.p)):
        x.p[i] += S.p[i]
        x.v[i] += S.v[i]
        x.a[i] += S.a[i]
        x.b[i] += S.b[i]


@part
def smooth_chunk(k0, count, f, steps, back):
    """Smooth the states of the steps k0 - window ... k0 - window + count - 1, in place.

    They stand in the rows 1 ... count of `steps`. Before step 0 there are none.
    """
    S, window, K, C, D, applied = back[0], f.window, f.K, f.C, f.D, f.applied
    rows, cycle = K.shape[0], f.cycle
    first, last = max(window - k0, 0) + 1, count  # the rows to smooth
    for i in range(len(S.p)):
        S.p[i] = S.v[i] = S.a[i] = S.b[i] = 0.0
    before = k0 - window - 1  # row number + before = step
    row = schedule_row(count + window + before, rows, cycle)
    for at in range(count + window, max(first, last), -1):
        if applied[row]:
            add_position(S, steps[at], K, row)
        add_force(S, steps[at], K, row)
        row = row_before(at + before, row, rows, cycle)
        carry_back(S, C, row)
    if first > last:
        return
    add_correction(steps[last], S)
    far = schedule_row(last + window + before, rows, cycle)
    for at in range(last, first, -1):
        if applied[row]:
            add_position(S, steps[at], K, row)
        if applied[far]:
            add_position(S, steps[at + window], D, row)
        add_force(S, steps[at], K, row)
        add_force(S, steps[at + window], D, row)
        far = row_before(at + window + before, far, rows, cycle)
        row = row_before(at + before, row, rows, cycle)
        carry_back(S, C, row)
        add_correction(steps[at - 1], S)
