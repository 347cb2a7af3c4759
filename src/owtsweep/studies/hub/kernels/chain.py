"""Runs a chain over a chunk of steps: filter, smoother, predictor.

A chain is a scheme as arrays (`ChainArrays`). A chunk is a stretch of a record whose steps are
computed together. First, `prepare` runs the filter and the smoother over a whole chunk. Then
`finish` makes the estimates of a part of the chunk. The part is so short that its estimates are
still in a near cache when their errors are summed. For a chain without smoother and predictor,
`finish` alone is called. For a chain with a predictor, `kernels.sums` may make the estimates
instead. Arguments are the structures of `kernels.layout`.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import FINAL, PREDICTED, WHOLE, filter_steps
from owtsweep.studies.hub.kernels.horizon import horizon_fix, horizon_steps, positions_from
from owtsweep.studies.hub.kernels.lagging import (
    begin_prediction,
    keep,
    leave_prediction,
    predict,
    recall,
    smooth_chunk,
)
from owtsweep.studies.hub.kernels.layout import Steps
from owtsweep.vectors.lanes import ROOMY, groups, load, store


@njit
def filter_span(steps, fed, chain, memory, width, late):
    """Run the filter over some steps of a chunk (a stretch of a record, computed together).

    Without an MHE (moving horizon estimator), the filter takes the position fixes. With an MHE, the
    filter takes the MHE's positions, which are computed here from one fix to the next.
    `filter_steps` explains the arguments and what is stored.
    """
    k0, first, stop, shift = steps
    mhe, registers, M = chain.mhe, memory.registers, chain.filter.fix_interval
    if not mhe.active:
        q = (k0 + first) // M
        positions = (fed.fixes, q, k0 + first - q * M, M)
        filter_steps(steps, fed, positions, chain, memory, width, late)
        return
    made, begun = memory.scratch.positions, first
    while first < stop:
        q = (k0 + first) // M
        end = min((q + 1) * M - k0, stop)
        at_fix = q * M == k0 + first
        if at_fix:
            horizon_fix(q, fed.fixes, mhe, registers)
        horizon_steps(Steps(k0, first, end, shift), fed, q, chain, memory)
        if at_fix and mhe.arrival:  # register 3 stores the state after this fix's correction
            positions = positions_from(k0, begun, mhe.interval, made)
            some = Steps(k0, begun, first + 1, shift)
            filter_steps(some, fed, positions, chain, memory, width, late)
            oldest, x = 3 * (q % (mhe.horizon + 1)), registers.x
            store(registers.arrival, oldest, load(x, 0))
            store(registers.arrival, oldest + 1, load(x, 1))
            store(registers.arrival, oldest + 2, load(x, 3))
            begun = first + 1
        first = end
    positions = positions_from(k0, begun, mhe.interval, made)
    filter_steps(Steps(k0, begun, stop, shift), fed, positions, chain, memory, width, late)


@njit
def is_filter(chain):
    """Return whether a chain (a scheme as arrays) has neither a smoother nor a predictor.

    The states of the filter are then the estimates.
    """
    return chain.filter.window == 0 and chain.predictor.steps == 0


@njit
def prepare(k0, count, fed, chain, memory, whole, late):
    """Filter and smooth the `count` steps of the chunk that begins at step k0 of the record.

    A chunk is a stretch of a record whose steps are computed together. The states are written to
    scratch.X in `memory`. Without a smoother, step k has its filtered state there; with a smoother,
    step k has the smoothed state of step k - window. If `whole` is true, or there is no predictor,
    a state has four rows: position, velocity, bias, acceleration. Otherwise a state has two rows:
    what the state adds to the predicted position and velocity. `fed`, `chain` and `memory` are
    `Fed`, `ChainArrays` and `Memory`. `late` is an array that is read after this call, with rows
    numbered as those of the force; the rows of `late` are prefetched.
    """
    window, registers, scratch = chain.filter.window, memory.registers, memory.scratch
    width = WHOLE if whole or chain.predictor.steps == 0 else PREDICTED
    recall(window, width, registers, scratch)
    filter_span(steps_of(k0, 0, count, 0), fed, chain, memory, width, late)
    keep(count, window, width, registers, scratch)
    if window == 0:
        return
    rows, source = (scratch.X, scratch.r, scratch.s), k0 - fed.base
    if ROOMY:
        smooth_chunk(k0, count, chain, width, rows, fed.force, source)
    else:  # group by group: the processor's registers do not hold more than one group
        X, r, s, force = groups(rows[0]), groups(rows[1]), groups(rows[2]), groups(fed.force)
        for g in range(len(X)):
            smooth_chunk(k0, count, chain, width, (X[g], r[g], s[g]), force[g], source)


@njit
def steps_of(k0, first, stop, shift):
    """Return the `Steps` first ... stop - 1 of the chunk that begins at step k0.

    The estimate of the chunk's step i belongs in row i - shift of the output. The arguments may be
    literal constants in the calling kernel.
    """
    return Steps(k0, first, stop, shift)


@njit
def finish(steps, fed, chain, memory, late):
    """Write the estimated positions and velocities of some steps of a chunk to memory.output.

    A chunk is a stretch of a record whose steps are computed together. The estimate of the chunk's
    step i goes to row i - steps.shift. If there is a smoother or a predictor, `prepare` must have
    processed the chunk. Otherwise the filter is run here: the innovation of step i goes to row i of
    memory.output, and rows of the array `late`, which is read after this call, are prefetched.
    `fed`, `chain` and `memory` are `Fed`, `ChainArrays` and `Memory`.
    """
    scratch, output = memory.scratch, memory.output
    if is_filter(chain):
        filter_span(steps, fed, chain, memory, FINAL, late)
    elif chain.predictor.steps > 0:
        k0, predictor = steps.k0, chain.predictor
        dv, dp = begin_prediction(k0, steps.first, fed.force, fed.base, predictor, scratch)
        for i in range(steps.first, steps.stop):
            at = k0 + i - fed.base
            x, w, dv, dp = predict(i, at, dv, dp, fed.force, predictor, scratch.X)
            store(output.position, i - steps.shift, x)
            store(output.velocity, i - steps.shift, w)
        leave_prediction(dv, dp, scratch)
    else:
        for i in range(steps.first, steps.stop):
            store(output.position, i - steps.shift, load(scratch.X, WHOLE * i))
            store(output.velocity, i - steps.shift, load(scratch.X, WHOLE * i + 1))
