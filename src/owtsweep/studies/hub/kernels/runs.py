"""Whole records through a chain, chunk by chunk, with their errors summed on the fly.

One call works through many chunks without coming back to Python. Everything a chunk leaves between
its stages stays in the second cache, and so do estimates until they are judged. `force`,
`fixes` and all fields of registers, scratch and output are tuples, an array per group of lanes; the
groups go through each stage side by side.

What memory must give is asked for ahead, by each stage about as much as its time is long: by the
filter the true velocity (and its own force, without a smoother), by the smoother the next chunk's
force, by the sums the true position.
"""

from __future__ import annotations

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.chain import finish, is_filter, prepare
from owtsweep.studies.hub.kernels.sums import direct_span, superposed_span
from owtsweep.vectors.lanes import borrowed, groups, load, store

#: Steps whose estimates are made before they are judged: few enough for the near caches, enough
#: that calls do not count.
PIECE = 250


@njit
def estimates(k0, count, force, base, fixes, chain, registers, scratch, output):
    """One chunk's estimates."""
    u, z, c = borrowed(force), borrowed(fixes), borrowed(chain)
    own, memory, out = borrowed(registers), borrowed(scratch), borrowed(output)
    if not is_filter(c):
        prepare(k0, count, u, base, z, c, own, memory, out, False, u)
    finish(k0, 0, count, u, base, z, c, own, memory, out, u)


@njit
def superposed(k0, stop, chunk, settled, force, base, fixes, position, velocity, direction, chain,
               weights, registers, scratch, output, sums):  # fmt: skip
    """Steps k0 ... stop - 1 of eight replicates in the groups motion, noise x, noise y."""
    u, z, c = borrowed(force), borrowed(fixes), borrowed(chain)
    own, memory, out = borrowed(registers), borrowed(scratch), borrowed(output)
    p, v = groups(borrowed((position, velocity)))
    w = borrowed(weights)
    cosines, total = borrowed(direction), borrowed((sums,))
    while k0 < stop:
        count = min(chunk, stop - k0)
        if not is_filter(c):
            prepare(k0, count, u, base, z, c, own, memory, out, False, v)
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            if c.predictor.steps == 0:
                finish(k0, first, end, u, base, z, c, own, memory, out, v)
            early = min(max(settled - k0, first), end)
            if early > first:
                superposed_span(k0, first, early, first, 0, p, v, u, base, memory, out, cosines, c,
                                w, total)  # fmt: skip
            if early < end:
                superposed_span(k0, early, end, first, 18, p, v, u, base, memory, out, cosines, c,
                                w, total)  # fmt: skip
        k0 += count


@njit
def direct(k0, stop, chunk, settled, force, base, fixes, position, velocity, direction, chain,
           weights, registers, scratch, output, sums, squared):  # fmt: skip
    """Steps k0 ... stop - 1 of eight replicates in the groups x and y of whole series."""
    u, z, c = borrowed(force), borrowed(fixes), borrowed(chain)
    own, memory, out = borrowed(registers), borrowed(scratch), borrowed(output)
    p, v = groups(borrowed((position, velocity)))
    w = borrowed(weights)
    cosines, total = borrowed(direction), borrowed((sums,))
    keep = squared.shape[0] > 0
    kept = borrowed((squared,))
    while k0 < stop:
        count = min(chunk, stop - k0)
        if not is_filter(c):
            prepare(k0, count, u, base, z, c, own, memory, out, False, v)
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            if c.predictor.steps == 0:
                finish(k0, first, end, u, base, z, c, own, memory, out, v)
            early = min(max(settled - k0, first), end)
            if early > first:
                direct_span(k0, first, early, first, 0, p, v, u, base, memory, out, cosines, c,
                            w, total, keep, kept)  # fmt: skip
            if early < end:
                direct_span(k0, early, end, first, 18, p, v, u, base, memory, out, cosines, c,
                            w, total, keep, kept)  # fmt: skip
        k0 += count


@njit
def states(k0, count, force, base, fixes, chain, registers, scratch, output, found):
    """Filtered or smoothed states (p, v, a, b) of one chunk, found (4 count, 8) of each group."""
    u, z, c = borrowed(force), borrowed(fixes), borrowed(chain)
    own, memory, out = borrowed(registers), borrowed(scratch), borrowed(output)
    target = borrowed(found)
    prepare(k0, count, u, base, z, c, own, memory, out, True, u)
    for row in range(0, 4 * count, 4):
        store(target, row, load(memory.X, row))
        store(target, row + 1, load(memory.X, row + 1))
        store(target, row + 2, load(memory.X, row + 3))
        store(target, row + 3, load(memory.X, row + 2))
