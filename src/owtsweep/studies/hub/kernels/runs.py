"""Whole records through a chain, chunk by chunk, with their errors summed on the fly.

One call works through many chunks without coming back to Python. Everything a chunk leaves between
its stages stays in the second cache, and so do estimates until they are judged. The groups of lanes
go through each stage side by side. Arguments are the structures of `kernels.layout`.

Each stage asks ahead for about as much as memory can give in its time: the filter for the true
velocity (and, without a smoother, for its force), the smoother for the next chunk's force, the sums
for the true position.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.chain import finish, is_filter, prepare, steps_of
from owtsweep.studies.hub.kernels.layout import Steps
from owtsweep.studies.hub.kernels.sums import direct_span, superposed_span
from owtsweep.vectors.lanes import borrowed, load, store

#: Steps whose estimates are made before they are judged: few enough for the near caches, enough
#: that calls do not count.
PIECE = 250


@njit
def estimates(k0, count, fed, chain, memory):
    """The estimates of the chunk of `count` steps that begins at step k0."""
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    if not is_filter(c):
        prepare(k0, count, inputs, c, m, False, inputs.force)
    finish(steps_of(k0, 0, count, 0), inputs, c, m, inputs.force)


@njit
def superposed(stretch, fed, truth, chain, weights, memory, sums):
    """Add up the products of eight replicates in the groups motion, noise x, noise y.

    `sums`: one array (36, 8), as in `kernels.sums`.
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
            early = min(max(settled - k0, first), end)
            if early > first:
                some = Steps(k0, first, early, first)
                superposed_span(some, inputs, true, c, m, w, total, 0)
            if early < end:
                some = Steps(k0, early, end, first)
                superposed_span(some, inputs, true, c, m, w, total, 18)
        k0 += count


@njit
def direct(stretch, fed, truth, chain, weights, memory, totals):
    """Add up the squared errors of eight replicates in the groups x and y of whole series."""
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    true, w, total = borrowed(truth), borrowed(weights), borrowed(totals)
    k0, stop, chunk, settled = stretch
    while k0 < stop:
        count = min(chunk, stop - k0)
        if not is_filter(c):
            prepare(k0, count, inputs, c, m, False, true.velocity)
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            if c.predictor.steps == 0:
                finish(Steps(k0, first, end, first), inputs, c, m, true.velocity)
            early = min(max(settled - k0, first), end)
            if early > first:
                direct_span(Steps(k0, first, early, first), inputs, true, c, m, w, total, 0)
            if early < end:
                direct_span(Steps(k0, early, end, first), inputs, true, c, m, w, total, 18)
        k0 += count


@njit
def states(k0, count, fed, chain, memory, result):
    """Filtered or smoothed states (p, v, a, b) of one chunk, into (4 count, 8) of each group."""
    inputs, c, m = borrowed(fed), borrowed(chain), borrowed(memory)
    target, X = borrowed(result), m.scratch.X
    prepare(k0, count, inputs, c, m, True, inputs.force)
    for row in range(0, 4 * count, 4):
        store(target, row, load(X, row))
        store(target, row + 1, load(X, row + 1))
        store(target, row + 2, load(X, row + 3))
        store(target, row + 3, load(X, row + 2))
