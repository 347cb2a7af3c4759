"""The multirate Kalman filter, Algorithm 6 of Ren et al. (2019), on many lanes.

A row (`Memory.steps`) holds a step's state p, v, a, b (position, velocity, acceleration, bias) and
its innovations.
"""

from __future__ import annotations

from owtsweep.compiled import part
from owtsweep.estimation.windowing import schedule_row
from owtsweep.studies.hub.kernels.horizon import choose_input, keep_state, make_position, take_fix
from owtsweep.studies.hub.kernels.predicting import add_input


@part
def next_row(row, rows, cycle):
    """Return the schedule's row of the next step; the last `cycle` rows repeat for ever."""
    return row + 1 if row + 1 < rows else rows - cycle


@part
def predict_and_correct(before, now, force, at, f, K, row):
    """Take a step with the specific force alone: m = A x + B u, r = f - h m, x = m + K r.

    The predicted position is left in now.s, for `correct`.

    before, now: the rows of the step before and of this step.
    force, at: the specific forces (rows, lanes), and the row of this step's.
    f, K, row: the filter (`FilterArrays`), its gains, and the row of the gains.
    """
    A, B, h = f.A, f.B, f.h
    a01, a02, a03, a12, a13, a22 = A[0, 1], A[0, 2], A[0, 3], A[1, 2], A[1, 3], A[2, 2]
    a00, a10, a11 = A[0, 0] - 1.0, A[1, 0], A[1, 1] - 1.0  # zero unless the IMU leans
    b0, b1, h0, h2, h3 = B[0], B[1], h[0], h[2], h[3]
    k0, k1, k2, k3 = K[row, 0, 1], K[row, 1, 1], K[row, 2, 1], K[row, 3, 1]
    for i in range(len(now.p)):
        p, v, a, b, u = before.p[i], before.v[i], before.a[i], before.b[i], force[at - 1, i]
        m0 = p + (b0 * u + a01 * v + a02 * a + a03 * b + a00 * p)
        m1 = v + (b1 * u + a12 * a + a13 * b + a11 * v + a10 * p)
        m2 = a22 * a
        r = force[at, i] - h3 * b - h2 * m2 - h0 * m0
        now.r[i] = r
        now.s[i] = m0
        now.p[i] = m0 + k0 * r
        now.v[i] = m1 + k1 * r
        now.a[i] = m2 + k2 * r
        now.b[i] = b + k3 * r


@part
def correct(now, positions, at, K, row):
    """Correct a step's state by a position: s = z - m, x = x + K s; z is row `at` of `positions`.

    K is computed for both measurements together, so m is the state before either.
    """
    k0, k1, k2, k3 = K[row, 0, 0], K[row, 1, 0], K[row, 2, 0], K[row, 3, 0]
    for i in range(len(now.p)):
        s = positions[at, i] - now.s[i]
        now.s[i] = s
        now.p[i] += k0 * s
        now.v[i] += k1 * s
        now.a[i] += k2 * s
        now.b[i] += k3 * s


@part
def filter_chunk(k0, count, fed, f, steps):
    """Filter the `count` steps from step k0 on; the states go to the last rows of `steps`.

    Row 0 holds the state before. `fed`, `f` and `steps` are `Fed`, `FilterArrays` and
    `Memory.steps`.
    """
    force, fixes, source = fed.force, fed.fixes, k0 - f.input_delay - fed.base
    K, applied, M, first = f.K, f.applied, f.fix_interval, f.window + 1
    rows, cycle = K.shape[0], f.cycle
    row, fix, since = schedule_row(k0, rows, cycle), k0 // M, k0 % M
    before = steps[0]
    for i in range(count):
        now = steps[first + i]
        predict_and_correct(before, now, force, source + i, f, K, row)
        if applied[row]:
            correct(now, fixes, fix, K, row)
        before = now
        row = next_row(row, rows, cycle)
        since += 1
        if since == M:
            fix, since = fix + 1, 0


@part
def filter_chunk_with_mhe(k0, count, fed, f, mhe, memory):
    """Filter as `filter_chunk` does, but with the positions of the MHE (HME2, Algorithm 2).

    The MHE is run on the way, as its arrival state is the filter's.
    """
    force, fixes, source = fed.force, fed.fixes, k0 - f.input_delay - fed.base
    steps, nodes, held = memory.steps, memory.nodes, memory.now[0]
    position = memory.position
    K, applied, M, first = f.K, f.applied, f.fix_interval, f.window + 1
    rows, cycle, half = K.shape[0], f.cycle, 0.5 * mhe.step * mhe.step
    row, fix, since = schedule_row(k0, rows, cycle), k0 // M, k0 % M
    phase = k0 % mhe.interval
    before = steps[0]
    for i in range(count):
        now = steps[first + i]
        if since == 0:
            take_fix(fix, fixes, mhe, nodes, held)
        if phase == 0 and fix >= mhe.first:
            make_position(mhe.growth, since, held, position)
        elif phase == 0 and since == 0:
            for j in range(len(now.p)):  # too few fixes for a window: the fix itself
                position[0, j] = fixes[fix, j]
        predict_and_correct(before, now, force, source + i, f, K, row)
        if applied[row]:
            correct(now, position, 0, K, row)
        before = now
        if since == 0 and mhe.arrival:
            keep_state(now, nodes[fix % len(nodes)])
        choose_input(held, force[source + i], mhe.inputs, phase == 0, mhe.interval)
        add_input(held, held.sample, mhe.step, half, mhe.lean)
        row = next_row(row, rows, cycle)
        since += 1
        if since == M:
            fix, since = fix + 1, 0
        phase = phase + 1 if phase + 1 < mhe.interval else 0
