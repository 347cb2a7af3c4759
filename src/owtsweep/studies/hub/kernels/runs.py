"""Runs a chain over records, chunk by chunk, and sums the errors during the run.

A chunk has so few steps that what filter, smoother, predictor and summation leave for the next of
them stays in the second-level cache. Arguments are the structures of `kernels.layout`.
"""

from __future__ import annotations

from owtsweep.compiled import njit, pasted
from owtsweep.studies.hub.kernels.filtering import filter_chunk, filter_chunk_with_mhe
from owtsweep.studies.hub.kernels.predicting import predict_chunk
from owtsweep.studies.hub.kernels.smoothing import smooth_chunk
from owtsweep.studies.hub.kernels.sums import sum_chunk


@pasted
def estimate(k0, count, fed, chain, memory, whole):
    """Estimate the `count` steps from step k0 on: [MHE ->] filter [-> smoother] [-> predictor].

    The estimate of step k0 + i is left in row 1 + i of memory.steps. If `whole` is true, there is
    no prediction: the row holds the whole state of step k0 + i - window. Call `leave` before the
    next chunk.
    """
    f, steps = chain.filter, memory.steps
    if chain.mhe.active:
        filter_chunk_with_mhe(k0, count, fed, f, chain.mhe, memory)
    else:
        filter_chunk(k0, count, fed, f, steps)
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


@njit
def run(stretch, fed, truth, chain, weights, memory, sums, squared):
    """Run a scheme on eight records; add the products of the errors to `sums`.

    stretch: (begin, stop, chunk, settled): the steps begin ... stop - 1 are processed `chunk` steps
        at a time; errors from step `settled` on count as settled.
    sums: what `layout.new_sums` makes: for three lanes per record, motion and noise apart, or for
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
