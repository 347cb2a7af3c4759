"""Runs a chain on many lanes and sums its errors: Algorithms 1, 6, 8 and 9 of Ren et al. (2019).

A row (`Memory.steps`) holds a step's state p, v, a, b (position, velocity, acceleration, bias) and
its innovations. A chunk has so few steps that what filter, smoother, predictor and summation leave
for the next of them stays in the second-level cache.

Filter, with the innovations i_k = (s, r) of position and specific force: x_{k|k} = x_{k|k-1} + K_k
i_k. Smoother, in O(1) operations per step: with the corrections e_k = K_k i_k and the gains C_k and
D_k, the smoothed state is x_{k|k} + S_k, where S_k = C_k (e_{k+1} + S_{k+1} + D_{k+1}
i_{k+1+window}): step k + 1 enters the sum, step k + 1 + window leaves it. This recursion is stable
backwards in time only. So each chunk starts it again, one window after the chunk's last state;
inside this window nothing leaves. Predictor: the past state times A^n, plus what the inputs
(specific forces) of the n steps add to position and velocity, a moving sum that takes the newest in
and leaves the oldest out.
"""

from __future__ import annotations

from owtsweep.compiled import njit, part, pasted
from owtsweep.estimation.windowing import next_row, row_before, schedule_row
from owtsweep.studies.hub.kernels.horizon import choose_input, keep_state, make_position, take_fix
from owtsweep.studies.hub.kernels.sums import sum_chunk


@njit
def run(stretch, fed, truth, chain, weights, memory, sums, squared):
    """Run a scheme on eight records; add the products of the errors to `sums`.

    stretch: (begin, stop, chunk, settled): the steps begin ... stop - 1 are processed `chunk` steps
        at a time; errors from step `settled` on count as settled.
    sums: what `batch.new_sums` makes: for three lanes per record, motion and noise apart, or for
        two, motion plus noise.
    squared: either (steps, 8), to be filled with the squared position error of each step of a run
        with two lanes per record, or empty.
    """
    k0, stop, chunk, settled = stretch
    f, steps = chain.filter, memory.steps
    while k0 < stop:
        count = min(chunk, stop - k0)
        estimate(k0, count, fed, chain, memory, False)
        sum_chunk(k0, count, settled, fed, truth, f, weights, steps, sums, squared)
        leave(count, f.window, steps)
        k0 += count


@pasted
def estimate(k0, count, fed, chain, memory, whole):
    """Estimate the `count` steps from step k0 on: [MHE ->] filter [-> smoother] [-> predictor].

    The estimate of step k0 + i is left in row 1 + i of memory.steps. If `whole` is true, there is
    no prediction: the row holds the whole state of step k0 + i - window. Call `leave` before the
    next chunk.
    """
    f, steps = chain.filter, memory.steps
    filter_chunk(k0, count, fed, f, chain.mhe, memory)
    steps[0] = steps[f.window + count]
    if f.window > 0:
        smooth_chunk(k0, count, f, steps, memory.back)
    if chain.predictor.steps > 0 and not whole:
        predict_chunk(k0, count, fed, chain.predictor, steps, memory.inputs)


@pasted
def leave(count, window, steps):
    """Keep the last `window` steps of a chunk, filtered and not smoothed yet, for the next one."""
    for i in range(1, window + 1):
        steps[i] = steps[count + i]


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
def filter_chunk(k0, count, fed, f, mhe, memory):
    """Filter the `count` steps from step k0 on; the states go to the last rows of memory.steps.

    Row 0 holds the state before. With an MHE (HME2, Algorithm 2) the filter takes its positions
    in place of the fixes. It is run on the way, as its arrival state is the filter's. `fed`, `f`
    and `mhe` are `Fed`, `FilterArrays` and `HorizonArrays`.
    """
    force, fixes, source = fed.force, fed.fixes, k0 - f.input_delay - fed.base
    steps, nodes, held = memory.steps, memory.nodes, memory.now[0]
    positions = memory.position if mhe.active else fixes
    K, applied, M, first = f.K, f.applied, f.fix_interval, f.window + 1
    rows, cycle, half = K.shape[0], f.cycle, 0.5 * mhe.step * mhe.step
    row, fix, since = schedule_row(k0, rows, cycle), k0 // M, k0 % M
    phase = k0 % mhe.interval
    before = steps[0]
    for i in range(count):
        now = steps[first + i]
        if mhe.active:
            if since == 0:
                take_fix(fix, fixes, mhe, nodes, held)
            if phase == 0 and fix >= mhe.first:
                make_position(mhe.growth, since, held, positions)
            elif phase == 0 and since == 0:
                for j in range(len(now.p)):  # too few fixes for a window: the fix itself
                    positions[0, j] = fixes[fix, j]
        predict_and_correct(before, now, force, source + i, f, K, row)
        if applied[row]:
            correct(now, positions, 0 if mhe.active else fix, K, row)
        before = now
        if mhe.active:
            if since == 0 and mhe.arrival:
                keep_state(now, nodes[fix % len(nodes)])
            choose_input(held, force[source + i], mhe.inputs, phase == 0, mhe.interval)
            add_input(held, held.sample, mhe.step, half, mhe.lean)
            phase = phase + 1 if phase + 1 < mhe.interval else 0
        row = next_row(row, rows, cycle)
        since += 1
        if since == M:
            fix, since = fix + 1, 0


@part
def add_innovation(S, innovation, G, row, column):
    """Add an innovation's part of a correction: S = S + G i, by the gains of the given row.

    innovation: of the position (the field s of a row) or of the specific force (r), of each lane.
    G: the filter's gains K or the smoother's D, whose column is 0 for positions, 1 for forces.
    """
    g0, g1, g2, g3 = G[row, 0, column], G[row, 1, column], G[row, 2, column], G[row, 3, column]
    for i in range(len(S.p)):
        e = innovation[i]
        S.p[i] += g0 * e
        S.v[i] += g1 * e
        S.a[i] += g2 * e
        S.b[i] += g3 * e


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
def clear(x):
    """Set a state to zero."""
    for i in range(len(x.p)):
        x.p[i] = x.v[i] = x.a[i] = x.b[i] = 0.0


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
    clear(S)
    before = k0 - window - 1  # row number + before = step
    row = schedule_row(count + window + before, rows, cycle)
    for at in range(count + window, max(first, last), -1):
        if applied[row]:
            add_innovation(S, steps[at].s, K, row, 0)
        add_innovation(S, steps[at].r, K, row, 1)
        row = row_before(at + before, row, rows, cycle)
        carry_back(S, C, row)
    if first > last:
        return
    add_correction(steps[last], S)
    far = schedule_row(last + window + before, rows, cycle)
    for at in range(last, first, -1):
        if applied[row]:
            add_innovation(S, steps[at].s, K, row, 0)
        if applied[far]:
            add_innovation(S, steps[at + window].s, D, row, 0)
        add_innovation(S, steps[at].r, K, row, 1)
        add_innovation(S, steps[at + window].r, D, row, 1)
        far = row_before(at + window + before, far, rows, cycle)
        row = row_before(at + before, row, rows, cycle)
        carry_back(S, C, row)
        add_correction(steps[at - 1], S)


@part
def add_input(sums, u, T, half, lean):
    """Integrate an input u twice over a step T, in place: p = p + T v + T^2/2 u, v = v + T u.

    `sums` is the row with p and v; `half` is T^2/2; `lean` are the `LeanTerms` of an IMU that
    leans.
    """
    pp, pv, pu, vp, vv, vu = lean.pp, lean.pv, lean.pu, lean.vp, lean.vv, lean.vu
    for i in range(len(sums.p)):
        p, v = sums.p[i], sums.v[i]
        sums.p[i] = p + (T * v + half * u[i]) + (pp * p + pv * v + pu * u[i])
        sums.v[i] = v + T * u[i] + (vp * p + vv * v + vu * u[i])


@part
def sum_inputs(sums, force, at, m):
    """Fill the row `sums` with what the inputs of the m.steps steps before row `at` add."""
    for i in range(len(sums.p)):
        sums.p[i] = sums.v[i] = 0.0
    for k in range(at - m.steps, at):
        add_input(sums, force[k], m.step, m.half, m.lean)


@part
def predict(x, sums, force, at, m):
    """Replace the past state in the row x by the prediction of now; move the sums on by a step.

    `sums` is the row with what the inputs of the last m.steps steps add. Row `at` of `force`
    (rows, lanes) is the newest input.
    """
    n, T, half, lean = m.steps, m.step, m.half, m.lean
    pv, pb, pp, vb, vp, vv = m.pv, m.pb, m.pp, m.vb, m.vp, m.vv
    new_p, new_v, first_p, first_v = m.new_p, m.new_v, m.first_p, m.first_v
    for i in range(len(x.p)):
        p, v, b, dp, dv = x.p[i], x.v[i], x.b[i], sums.p[i], sums.v[i]
        new, old = force[at, i], force[at - n, i]
        x.p[i] = p + pv * v + pb * b + pp * p + dp + (new_p * new - first_p * old)
        x.v[i] = v + vb * b + vp * p + vv * v + dv + (new_v * new - first_v * old)
        of_lean = lean.vp * dp + lean.vv * dv + lean.vu * new - m.old_v * old
        sums.p[i] = dp + (T * dv + half * new - m.old_p * old) + (lean.pp * dp + lean.pv * dv)
        sums.v[i] = dv + T * (new - old) + of_lean


@part
def predict_chunk(k0, count, fed, m, steps, inputs):
    """Predict the `count` steps from step k0 on, from the states in the rows 1, 2, ... of `steps`.

    The moving sums are computed again for every chunk, so that rounding errors do not accumulate.
    """
    force, start, sums = fed.force, k0 - fed.base, inputs[0]
    sum_inputs(sums, force, start, m)
    for i in range(count):
        predict(steps[1 + i], sums, force, start + i, m)
