"""The whole chain of a scheme over a chunk of eight lanes: filter, smoother, predictor."""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.filtering import filter_steps
from owtsweep.studies.hub.kernels.horizon import horizon_fix, horizon_steps
from owtsweep.studies.hub.kernels.lagging import keep, predict_chunk, recall, smooth_chunk
from owtsweep.studies.hub.kernels.vector import load, store


@njit
def filter_chunk(k0, count, force, base, fixes, chain, registers, scratch, output, final):
    """The filter over a chunk, fed by the fixes or, interval by interval, by the MHE."""
    arrays, mhe, x = chain.filter, chain.mhe, registers.x
    M = arrays.fix_interval
    source = k0 - arrays.input_delay - base
    q = k0 // M
    if not mhe.active:
        filter_steps(k0, 0, count, force, source, fixes, q, k0 - q * M, M, arrays, x, scratch,
                     output, final)  # fmt: skip
        return
    positions = scratch.positions
    first = 0
    while first < count:
        q = (k0 + first) // M
        stop = min((q + 1) * M - k0, count)
        at_fix = q * M == k0 + first
        if at_fix:
            horizon_fix(q, fixes, mhe, registers)
        horizon_steps(k0, first, stop, force, source, q, fixes, mhe, M, registers, positions)
        if at_fix and mhe.arrival:  # register 3 takes the state that this fix has corrected
            filter_steps(k0, first, first + 1, force, source, positions, first, 0, 1, arrays, x,
                         scratch, output, final)  # fmt: skip
            oldest = 3 * (q % (mhe.horizon + 1))
            store(registers.arrival, oldest, load(x, 0))
            store(registers.arrival, oldest + 1, load(x, 1))
            store(registers.arrival, oldest + 2, load(x, 3))
            first += 1
        filter_steps(k0, first, stop, force, source, positions, first, 0, 1, arrays, x, scratch,
                     output, final)  # fmt: skip
        first = stop


@njit
def states_chunk(k0, count, force, base, fixes, chain, registers, scratch, output):
    """Leave filtered or smoothed states in scratch.X, `window` steps late, four rows per step."""
    window = chain.filter.window
    recall(window, registers, scratch)
    filter_chunk(k0, count, force, base, fixes, chain, registers, scratch, output, False)
    keep(count, window, registers, scratch)
    if window > 0:
        smooth_chunk(k0, count, chain.filter, scratch)


@njit
def chain_chunk(k0, count, force, base, fixes, chain, registers, scratch, output):
    """Estimates of steps k0 ... k0 + count - 1; `force` holds step k in row k - base."""
    position, velocity = output.position, output.velocity
    if chain.filter.window == 0 and chain.predictor.steps == 0:
        filter_chunk(k0, count, force, base, fixes, chain, registers, scratch, output, True)
        return
    states_chunk(k0, count, force, base, fixes, chain, registers, scratch, output)
    if chain.predictor.steps > 0:
        predict_chunk(k0, count, force, base, chain.predictor, scratch, position, velocity)
    else:
        for i in range(count):
            store(position, i, load(scratch.X, 4 * i))
            store(velocity, i, load(scratch.X, 4 * i + 1))
