"""Runs a chain on given series: yields the estimates, or the filter's states, of each step."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array, Rows, aligned
from owtsweep.studies.hub.batch import arrays_of, chunk_of, lead_of, new_memory
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.kernels.layout import WIDTH, Fed

#: Number of lanes that are run together: as in a direct run of the batch engine, whose compiled
#: kernels then serve here too.
LANES = 2 * WIDTH


class Estimates(NamedTuple):
    """The estimates of steps: position, velocity, innovation; (steps, lanes) each, m, m/s and m."""

    position: Array
    velocity: Array
    innovation: Array


def trajectories(chain: Chain, force: Array, fixes: Array) -> tuple[Array, Array, Array]:
    """Run a chain over whole records; return position, velocity and innovation at each step.

    They are in m, m/s and m, shape (steps, lanes) each. `force` and `fixes` are in NED, m/s^2 and
    m, shapes (steps, lanes) and (fixes, lanes).
    """
    result = (np.empty(force.shape), np.empty(force.shape), np.empty(force.shape))
    for k0, n, output in chunks(chain, force, fixes):
        for out, source in zip(result, output, strict=True):
            out[k0 : k0 + n] = source[:n]
    return result


def chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Estimates]]:
    """Run a chain over series; yield the estimates of successive chunks.

    `force` and `fixes` are in NED, m/s^2 and m, shapes (steps, lanes) and (fixes, lanes). Yielded
    are the chunk's first step, its number of steps n, and the estimates, of which the first n rows
    are valid. The next chunk overwrites them.
    """
    width, window = force.shape[1], chain.filter.window
    flat = Estimates(*(np.zeros((chunk_of(chain)[0], width)) for _ in Estimates._fields))
    for k0, n, lanes, rows in _one_by_one(chain, force, fixes, of_filter=False):
        own = slice(lanes.stop - lanes.start)
        flat.position[:n, lanes] = rows["p"][1 : 1 + n, own]
        flat.velocity[:n, lanes] = rows["v"][1 : 1 + n, own]
        applied = chain.gains.applied[chain.gains.row(np.arange(k0, k0 + n))]
        innovation = rows["s"][1 + window : 1 + window + n, own]
        flat.innovation[:n, lanes] = np.where(applied[:, None], innovation, np.nan)
        if lanes.stop == width:
            yield k0, n, flat


def states(chain: Chain, force: Array, fixes: Array) -> Array:
    """Compute the states of a chain's filter, smoothed if the chain has a smoother.

    `force` and `fixes` are in NED, m/s^2 and m, shapes (steps, lanes) and (fixes, lanes). The
    result has the shape (steps, 4, lanes): position (m), velocity (m/s), acceleration and b
    (m/s^2). Here b is the state x4 = -R b^b + g of Eq. (6) of Ren et al. (2019): bias and gravity.
    Row k is the state of step k - D - W, where D is the chain's input delay and W its smoother's
    lag, both in steps. The first W rows are zero.
    """
    result = np.empty((force.shape[0], 4, force.shape[1]))
    for k0, n, some in state_chunks(chain, force, fixes):
        result[k0 : k0 + n] = some[:n]
    return result


def state_chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Array]]:
    """Compute the rows that `states` returns, but yield them in chunks of successive rows.

    Yielded are the number of the chunk's first row, its number of rows n, and the states, shape
    (rows, 4, lanes), of which the first n rows are valid. The next chunk overwrites them.
    """
    width = force.shape[1]
    flat = np.empty((chunk_of(chain)[0], 4, width))
    for k0, n, lanes, rows in _one_by_one(chain, force, fixes, of_filter=True):
        for state, field in enumerate("pvab"):
            flat[:n, state, lanes] = rows[field][1 : 1 + n, : lanes.stop - lanes.start]
        if lanes.stop == width:
            yield k0, n, flat


def _one_by_one(
    chain: Chain, force: Array | OnePassSeries, fixes: Array, *, of_filter: bool
) -> Iterator[tuple[int, int, slice, Rows]]:
    """Run a chain on pieces that kernels process at once: a chunk of steps, and some lanes.

    Yield first step, number of steps, indices of the lanes, and the rows of the chain's memory,
    which hold estimates, or states of the filter. The pieces of one chunk follow each other.
    """
    from owtsweep.studies.hub.kernels.chain import estimate, leave

    (steps, width), chunk, lead = force.shape, chunk_of(chain)[0], lead_of(chain)
    positions, arrays = _in_groups(fixes, 0, len(fixes)), arrays_of(chain)
    memories = [new_memory(arrays, LANES, chunk) for _ in positions]
    for k0 in range(0, steps, chunk):
        n = min(chunk, steps - k0)
        for g, rows in enumerate(_in_groups(force, k0 - lead, k0 + n)):
            lanes = slice(g * LANES, min((g + 1) * LANES, width))
            fed, memory = Fed(rows, k0 - lead, positions[g]), memories[g]
            estimate(k0, n, fed, arrays, memory, of_filter)
            yield k0, n, lanes, memory.steps
            leave(n, chain.filter.window, memory.steps)


def _in_groups(values: Array | OnePassSeries, first: int, stop: int) -> Array:
    """Return rows `first` to `stop` - 1 of values (rows, lanes), regrouped: (groups, rows, LANES).

    Zeros stand for rows before row 0, and for the lanes that the last group lacks.
    """
    result = aligned(-(-values.shape[1] // LANES), stop - first, LANES)
    given = values[max(first, 0) : stop]
    for g, rows in enumerate(result):
        some = given[:, g * LANES : (g + 1) * LANES]
        rows[max(-first, 0) :, : some.shape[1]] = some
    return result


class OnePassSeries:
    """A series that is read like an array (steps, lanes), but made piece by piece.

    Slices must be read in order of time: when the next piece is made, the rows before the current
    slice are dropped. Reading a dropped row raises IndexError.

    pieces: iterator over arrays of successive rows.
    shape: of the whole series.
    """

    def __init__(self, pieces: Iterator[Array], shape: tuple[int, int]) -> None:
        self.shape = shape
        self._pieces = pieces
        self._rows: Array = np.empty((0, shape[1]))
        self._first = 0

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, part: slice) -> Array:
        begin, stop, _ = part.indices(self.shape[0])
        if begin < self._first:
            raise IndexError(
                f"row {begin} has been forgotten; the first row in memory is {self._first}"
            )
        while self._first + len(self._rows) < stop:
            kept = self._rows[begin - self._first :]
            self._first += len(self._rows) - len(kept)
            self._rows = np.concatenate([kept, next(self._pieces)])
        return self._rows[begin - self._first : stop - self._first]
