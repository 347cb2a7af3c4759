"""The predictor, Algorithm 9 of Ren et al. (2019): the model alone, from a past state to now.

The model is linear. So the prediction is the past state times A^n, plus what the inputs
(specific forces) of the n steps add to position and velocity. The latter is a moving sum: in each
step the newest input is included and the oldest left out.
"""

from __future__ import annotations

from owtsweep.compiled import part


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
    for i in range(len(sums.p)):
        sums.p[i] = sums.v[i] = 0.0
    for at in range(start - m.steps, start):
        add_input(sums, force[at], m.step, m.half, m.lean)
    for i in range(count):
        predict(steps[1 + i], sums, force, start + i, m)
