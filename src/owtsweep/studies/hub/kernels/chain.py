"""The whole chain of a scheme over a chunk: filter, smoother, predictor.

In two parts: `prepare` takes a whole chunk through filter and smoother; `finish` makes the
estimates of some of its steps, few enough that they are still in a near cache when they are
judged. A chain that is a filter alone has nothing to prepare.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import FINAL, PREDICTED, WHOLE, filter_steps
from owtsweep.studies.hub.kernels.horizon import horizon_fix, horizon_steps, tick_of
from owtsweep.studies.hub.kernels.lagging import (
    begin_prediction,
    keep,
    leave_prediction,
    predict,
    recall,
    smooth_chunk,
)
from owtsweep.vectors.lanes import ROOMY, groups, load, store


@njit
def filter_span(k0, first, stop, force, base, fixes, chain, registers, scratch, output, shift,
                width, late):  # fmt: skip
    """The filter over a chunk's steps, fed by the fixes or, interval by interval, by the MHE."""
    arrays, mhe, x = chain.filter, chain.mhe, registers.x
    M = arrays.fix_interval
    source = k0 - arrays.input_delay - base
    if not mhe.active:
        q = (k0 + first) // M
        filter_steps(k0, first, stop, force, source, fixes, q, k0 + first - q * M, M, chain, x,
                     scratch, output, shift, width, late)  # fmt: skip
        return
    positions, begun = scratch.positions, first
    while first < stop:
        q = (k0 + first) // M
        end = min((q + 1) * M - k0, stop)
        at_fix = q * M == k0 + first
        if at_fix:
            horizon_fix(q, fixes, mhe, registers)
        horizon_steps(k0, first, end, force, source, q, fixes, mhe, M, registers, positions)
        if at_fix and mhe.arrival:  # register 3 takes the state that this fix has corrected
            filter_steps(k0, begun, first + 1, force, source, positions,
                         tick_of(k0, begun, mhe.interval), (k0 + begun) % mhe.interval,
                         mhe.interval, chain, x, scratch, output, shift, width, late)  # fmt: skip
            oldest = 3 * (q % (mhe.horizon + 1))
            store(registers.arrival, oldest, load(x, 0))
            store(registers.arrival, oldest + 1, load(x, 1))
            store(registers.arrival, oldest + 2, load(x, 3))
            begun = first + 1
        first = end
    filter_steps(k0, begun, stop, force, source, positions, tick_of(k0, begun, mhe.interval),
                 (k0 + begun) % mhe.interval, mhe.interval, chain, x, scratch, output, shift, width,
                 late)  # fmt: skip


@njit
def is_filter(chain):
    """Whether the filter's states are the estimates."""
    return chain.filter.window == 0 and chain.predictor.steps == 0


@njit
def prepare(k0, count, force, base, fixes, chain, registers, scratch, output, whole, late):
    """Leave filtered or smoothed states in scratch.X, `window` steps late.

    There are four rows per step, (p, v, b, a); unless they are wanted `whole`, two, of what the
    predictor takes of them.
    `late` are rows, based as the force's, that are read once the states are there.
    """
    window = chain.filter.window
    width = WHOLE if whole or chain.predictor.steps == 0 else PREDICTED
    recall(window, width, registers, scratch)
    filter_span(k0, 0, count, force, base, fixes, chain, registers, scratch, output, 0, width,
                late)  # fmt: skip
    keep(count, window, width, registers, scratch)
    if window == 0:
        return
    if ROOMY:
        smooth_chunk(k0, count, chain, width, scratch.X, scratch.r, scratch.s, force, k0 - base)
    else:  # group by group: a group has enough to do while a step waits, and all of it fits
        X, r, s = groups(scratch.X), groups(scratch.r), groups(scratch.s)
        u = groups(force)
        for g in range(len(X)):
            smooth_chunk(k0, count, chain, width, X[g], r[g], s[g], u[g], k0 - base)


@njit
def finish(k0, first, stop, force, base, fixes, chain, registers, scratch, output, late):
    """Estimates of the chunk's steps first ... stop - 1, from row 0 of the output on.

    `force` holds step k in row k - base. Innovations stay in the row of their step.
    """
    if is_filter(chain):
        filter_span(k0, first, stop, force, base, fixes, chain, registers, scratch, output, first,
                    FINAL, late)  # fmt: skip
    elif chain.predictor.steps > 0:
        predictor = chain.predictor
        dv, dp = begin_prediction(k0, first, force, base, predictor, scratch)
        for i in range(first, stop):
            at = k0 + i - base
            x, w, dv, dp = predict(i, at, dv, dp, force, predictor, scratch.X)
            store(output.position, i - first, x)
            store(output.velocity, i - first, w)
        leave_prediction(dv, dp, scratch)
    else:
        for i in range(first, stop):
            store(output.position, i - first, load(scratch.X, WHOLE * i))
            store(output.velocity, i - first, load(scratch.X, WHOLE * i + 1))
