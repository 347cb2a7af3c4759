"""Runs a chain over records, chunk by chunk, and sums the errors during the run.

A chain is a scheme as arrays; a chunk is a stretch of a record whose steps are computed together.
One call processes many chunks without returning to Python. What one stage
(filter, smoother, predictor, summation) leaves for the next stays in the second-level cache, and so
do estimates until their errors are summed. Each stage processes the groups of eight lanes side by
side. Arguments are the structures of `kernels.layout`.

Each stage prefetches about as much data as memory can deliver meanwhile. The filter prefetches the
true velocity (and, without a smoother, the force), the smoother prefetches the next chunk's force,
and the summation of errors prefetches the true position.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.chain import finish, is_filter, prepare, steps_of
from owtsweep.studies.hub.kernels.layout import Steps
from owtsweep.studies.hub.kernels.sums import direct_span, superposed_span
from owtsweep.vectors.lanes import borrowed, load, store

#: Number of steps whose estimates are made before their errors are summed: few enough that the
#: estimates fit the near caches, but enough that the calls take little time.
PIECE = 250


@njit
def estimates(k0, count, fed, chain, memory):
    """Compute the estimates of `count` steps, from step k0 on, and write them to memory.output.

    `count` is at most the number of steps for which `memory` was made. `fed`, `chain` and `memory`
    are `Fed`, `ChainArrays` and `Memory`.
    """
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    if not is_filter(c):
        prepare(k0, count, inputs, c, m, False, inputs.force)
    finish(steps_of(k0, 0, count, 0), inputs, c, m, inputs.force)


@njit
def _window(k0, at, end, settled):
    """Return the step of the chunk at which the window of step `at` ends, and its row in the sums.

    The record's steps before step `settled` are one window, its other steps another. A window ends
    at the step `end` if not before. One call of the summation serves both windows: with the row as
    a constant, numba would compile the summation once for each.
    """
    if k0 + at < settled:
        return min(settled - k0, end), 0
    return end, 18


@njit
def superposed(stretch, fed, truth, chain, weights, memory, sums):
    """Run a scheme on eight records, motion and noise apart; add products of the errors to `sums`.

    There are three groups of eight lanes: the motion, the noise of x and the noise of y. Each
    record has one lane in each group. The other arguments are structures of `kernels.layout`.

    Parameters
    ----------
    stretch
        (begin, stop, chunk, settled): the steps begin ... stop - 1 are processed `chunk` steps at a
        time; errors from step `settled` on count as settled.
    sums
        A tuple of one array (36, 8), with the rows that the docstring of `kernels.sums` explains.
    """
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    true, w, total = borrowed(truth), borrowed(weights), borrowed(sums)
    k0, stop, chunk, settled = stretch
    while k0 < stop:
        count = min(chunk, stop - k0)
        if not is_filter(c):
            prepare(k0, count, inputs, c, m, False, true.velocity)
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            if c.predictor.steps == 0:
                finish(Steps(k0, first, end, first), inputs, c, m, true.velocity)
            at = first
            while at < end:
                until, top = _window(k0, at, end, settled)
                some = Steps(k0, at, until, first)
                superposed_span(some, inputs, true, c, m, w, total, top)
                at = until
        k0 += count


@njit
def direct(stretch, fed, truth, chain, weights, memory, sums, squared):
    """Run a scheme on eight records, motion plus noise; add the squares of the errors to `sums`.

    There are two groups of eight lanes, x and y. Each record has one lane in each group. `squared`
    is a tuple of one array: either (steps, 8), to be filled with the squared position error of each
    step, or empty. The other arguments are those of `superposed`.
    """
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    true, w = borrowed(truth), borrowed(weights)
    total = (borrowed(sums), borrowed(squared), len(squared[0]) > 0)
    k0, stop, chunk, settled = stretch
    while k0 < stop:
        count = min(chunk, stop - k0)
        if not is_filter(c):
            prepare(k0, count, inputs, c, m, False, true.velocity)
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            if c.predictor.steps == 0:
                finish(Steps(k0, first, end, first), inputs, c, m, true.velocity)
            at = first
            while at < end:
                until, top = _window(k0, at, end, settled)
                direct_span(Steps(k0, at, until, first), inputs, true, c, m, w, total, top)
                at = until
        k0 += count


@njit
def states(k0, count, fed, chain, memory, result):
    """Write the states of `count` steps, from step k0 on: filtered, or smoothed with a smoother.

    The states are written to `result`, which has an array (4 count, 8) for each group of eight
    lanes. Each step has four rows: position, velocity, acceleration, bias. With a smoother, the
    rows of step k hold the state of step k - window.
    """
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    target, X = borrowed(result), m.scratch.X
    prepare(k0, count, inputs, c, m, True, inputs.force)
    for row in range(0, 4 * count, 4):
        store(target, row, load(X, row))
        store(target, row + 1, load(X, row + 1))
        store(target, row + 2, load(X, row + 3))
        store(target, row + 3, load(X, row + 2))
