"""The batch engine: runs chains over all replicates of a block and sums their squared errors.

A chain is a scheme as arrays for kernels. A lane is one series along one axis; kernels run eight
lanes, a group, at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, aligned
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.feed import Feed, Span
from owtsweep.studies.hub.feed import Lanes as Lanes  # imported from here elsewhere
from owtsweep.studies.hub.fix_lines import sum_line_errors
from owtsweep.studies.hub.kernels.layout import (
    WIDTH,
    ChainArrays,
    Fed,
    Memory,
    Output,
    Scratch,
    Truth,
    Weights,
    new_output,
    new_registers,
    new_scratch,
)
from owtsweep.studies.hub.one_pass import OnePassSeries
from owtsweep.studies.hub.records import Records

#: Number of steps that kernels process at once, a chunk: so few that the buffers of eight lanes fit
#: the second-level cache.
CHUNK = 500


class Sums(NamedTuple):
    """A chain's sums of squared errors over a record, and their numbers of terms.

    Attributes
    ----------
    products
        Sums, shape (2, 6, 3, replicates): windows (before and after settling), quantities (x, y,
        vx, vy, NEES, NIS), products (motion x motion, motion x noise, noise x noise).
    steps, covariances, innovations
        Numbers of steps, of steps with a covariance and of innovations in each window, shape (2,)
        each.
    squared
        Squared position error of each step, shape (steps, replicates); (0, replicates) if not kept.
    """

    products: Array
    steps: NDArray[np.int64]
    covariances: NDArray[np.int64]
    innovations: NDArray[np.int64]
    squared: Array


def sum_errors(
    chains: Sequence[Chain],
    records: Records,
    settled: int,
    amplitude: float | None = None,
    *,
    keep_squared: bool = False,
    consistency: bool = True,
) -> list[Sums]:
    """Run chains on all replicates of some records; return each chain's sums of squared errors.

    All chains run on one span of the records before the next span is made. A chain whose estimates
    follow straight lines need not run if motion and noise are apart (see `fix_lines`).

    Parameters
    ----------
    settled
        The first settled step.
    amplitude
        Amplitude of the motion, m: whole series (motion plus noise) are run, and the squares of
        their errors are product 2 of `Sums`. None: motion and noise are run separately, and all
        three products of their errors are summed.
    keep_squared
        Whether the squared position error of each step is kept; only with an amplitude.
    consistency
        Whether NEES is computed; otherwise NEES is zero.
    """
    lines = {chain: chain.line for chain in chains if chain.line and amplitude is None}
    others = [chain for chain in chains if chain not in lines]
    weights = [weights_of(chain, consistency=consistency) for chain in others]
    memory = shared_memory(others, 3 if amplitude is None else 2)

    def run_eight(part: Records, first: int) -> list[tuple[Array, Array]]:
        """Return each chain's sums and squared errors for the replicates first ... first + 7."""
        feed = Feed(part, first, amplitude)
        runs = [
            ChainRun(*pair, feed, settled, *memory, keep=keep_squared)
            for pair in zip(others, weights, strict=True)
        ]
        for span in feed.spans(max(run.lead for run in runs)) if runs else ():
            for run in runs:
                run.advance(span)
        arrays: dict[Chain, tuple[Array, Array]] = {
            chain: (run.sums, run.squared) for chain, run in zip(others, runs, strict=True)
        }
        sums = sum_line_errors(list(lines.values()), feed, settled) if lines else []
        arrays |= {chain: (one, one[:0]) for chain, one in zip(lines, sums, strict=True)}
        count = len(feed.indices)
        return [(arrays[chain][0][:, :count], arrays[chain][1][:, :count]) for chain in chains]

    eights = [
        run_eight(part, first)
        for part in records.parts()
        for first in range(0, len(part.replicates), WIDTH)
    ]
    return [
        _joined(chain, records.steps, settled, arrays)
        for chain, arrays in zip(chains, zip(*eights, strict=True), strict=True)
    ]


def weights_of(chain: Chain, *, consistency: bool = True) -> Weights:
    """Return a chain's weights of errors in NEES and NIS.

    Without `consistency` the weights of NEES are zero.
    """
    return Weights(
        precision=chain.precision if consistency else np.zeros((chain.gains.rows, 3)),
        innovation=chain.innovation_weight,
        fresh=chain.gains.fresh,
    )


class ChainRun:
    """A run of one chain on eight replicates; it takes the records span by span."""

    def __init__(
        self,
        chain: Chain,
        weights: Weights,
        feed: Feed,
        settled: int,
        scratch: Scratch,
        output: Output,
        *,
        keep: bool = False,
    ) -> None:
        self.weights, self.feed, self.settled = weights, feed, settled
        self.steps = feed.records.steps
        self.arrays = arrays_of(chain)
        self.chunk, self.lead = chunk_of(chain)
        registers = new_registers(feed.groups, chain.filter.window, chain.mhe.horizon)
        self.memory = Memory(registers, scratch, output)
        self.fixes = tuple(feed.fixes)
        self.sums = np.zeros((36, WIDTH))
        self.squared = np.empty((self.steps if keep else 0, WIDTH))
        self.done = 0

    def advance(self, span: Span) -> None:
        """Run the chain up to the last whole chunk that ends in this span.

        The span at the record's end is run to its end.
        """
        from owtsweep.studies.hub.kernels import runs

        ready = span.stop if span.stop == self.steps else span.stop // self.chunk * self.chunk
        stretch = (self.done, ready, self.chunk, self.settled)
        fed = Fed(tuple(span.force), span.base, self.fixes)
        amplitude = 1.0 if self.feed.amplitude is None else self.feed.amplitude
        direction = self.feed.records.direction * amplitude
        truth = Truth((span.position,), (span.velocity,), direction)
        work = (stretch, fed, truth, self.arrays, self.weights, self.memory, (self.sums,))
        if self.feed.amplitude is None:
            runs.superposed(*work)
        else:
            runs.direct(*work, (self.squared,))
        self.done = ready


def shared_memory(chains: Sequence[Chain], groups: int) -> tuple[Scratch, Output]:
    """Make working memory that some chains use in turn, so that it stays in the cache.

    `groups` is the number of groups of eight lanes.
    """
    chunk = max((chunk_of(chain)[0] for chain in chains), default=0)
    window = max((chain.filter.window for chain in chains), default=0)
    return new_scratch(groups, chunk, window), new_output(groups, chunk)


def _joined(chain: Chain, steps: int, settled: int, parts: Sequence[tuple[Array, Array]]) -> Sums:
    """Join the sums and squared errors of parts, each of up to eight replicates, to `Sums`."""
    early, whole = (chain.gains.fresh_before(step) for step in (settled, steps))
    products, squared = (np.concatenate(arrays, axis=1) for arrays in zip(*parts, strict=True))
    lengths = np.array([settled, steps - settled])
    return Sums(
        products=products.reshape(2, 6, 3, -1),
        steps=lengths,
        covariances=lengths if chain.has_covariance else np.zeros_like(lengths),
        innovations=np.array([early, whole - early]),
        squared=squared,
    )


def arrays_of(chain: Chain) -> ChainArrays:
    """Return a chain as the structure of arrays that kernels take."""
    return ChainArrays(chain.filter, chain.predictor, chain.mhe)


def chunk_of(chain: Chain) -> tuple[int, int]:
    """Return the number of steps in a chunk, and the number of rows to keep for the next span.

    The end of a span that fills no whole chunk is processed with the next span. Therefore the rows
    of a chunk are kept, and the rows before it to which the predictor and the delay reach back.
    """
    chunk = max(CHUNK, 2 * chain.filter.window, 2 * chain.predictor.steps)
    return chunk, chunk + lead_of(chain)


class Estimates(NamedTuple):
    """A chunk's estimates: position, velocity and innovation, shape (steps, lanes) each."""

    position: Array
    velocity: Array
    innovation: Array


def trajectories(
    chain: Chain, sensors: Sensors, force: Array, fixes: Array
) -> tuple[Array, Array, Array]:
    """Run a chain over whole records; return position, velocity and innovation at each step.

    A lane is one series along one axis.

    Parameters
    ----------
    force, fixes
        Specific force in NED, m/s^2, shape (steps, lanes), and position fixes, m, shape
        (fixes, lanes).

    Returns
    -------
    tuple of array
        Estimated position and velocity, and the filter's innovation, shape (steps, lanes) each.
    """
    result = (np.empty(force.shape), np.empty(force.shape), np.empty(force.shape))
    for k0, n, output in chunks(chain, force, fixes):
        for out, source in zip(result, output, strict=True):
            out[k0 : k0 + n] = source[:n]
    return result


def chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Estimates]]:
    """Run a chain over series, chunk by chunk; yield first step, number of steps, and estimates.

    `force` and `fixes` are as for `trajectories`. The estimates are overwritten by the next chunk.
    """
    from owtsweep.studies.hub.kernels import runs

    width = force.shape[1]
    flat = Estimates(*(np.zeros((chunk_of(chain)[0], width)) for _ in Estimates._fields))
    for k0, n, lanes, fed, memory in _one_by_one(chain, force, fixes):
        runs.estimates(k0, n, fed, arrays_of(chain), memory)
        for out, source in zip(flat, memory.output, strict=True):
            out[:, lanes] = source[0][:, : lanes.stop - lanes.start]
        if lanes.stop == width:
            yield k0, n, flat


def states(chain: Chain, force: Array, fixes: Array) -> Array:
    """Compute the states of a chain's filter, smoothed if the chain has a smoother.

    Row k is the state of step k - window in the filter's time, which lags behind by the chain's
    input delay. The first `window` rows are zero. `force` and `fixes` are as for `trajectories`.

    Returns
    -------
    Array
        Shape (steps, 4, lanes): position (m), velocity (m/s), acceleration and b (m/s^2), where b
        is the state x4 = -R b^b + g of Eq. (6) of Ren et al. (2019), bias and gravity.
    """
    result = np.empty((force.shape[0], 4, force.shape[1]))
    for k0, n, some in state_chunks(chain, force, fixes):
        result[k0 : k0 + n] = some[:n]
    return result


def state_chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Array]]:
    """Compute what `states` returns chunk by chunk.

    Yield the first step, the number of steps, and the states, shape (chunk, 4, lanes). The states
    are overwritten by the next chunk.
    """
    from owtsweep.studies.hub.kernels import runs

    width, chunk = force.shape[1], chunk_of(chain)[0]
    eight, flat = np.empty((chunk, 4, WIDTH)), np.empty((chunk, 4, width))
    rows = (eight.reshape(-1, WIDTH),)
    for k0, n, lanes, fed, memory in _one_by_one(chain, force, fixes):
        runs.states(k0, n, fed, arrays_of(chain), memory, rows)
        flat[:, :, lanes] = eight[:, :, : lanes.stop - lanes.start]
        if lanes.stop == width:
            yield k0, n, flat


def _one_by_one(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, slice, Fed, Memory]]:
    """Go through the chunks of series, and through their groups of eight lanes.

    Yield the first step, the number of steps, the lanes, the inputs and the memory of each group.
    """
    (steps, width), chunk, lead = force.shape, chunk_of(chain)[0], lead_of(chain)
    positions = _in_groups(fixes, 0, len(fixes))
    shared = shared_memory([chain], 1)
    window, horizon = chain.filter.window, chain.mhe.horizon
    memories = [Memory(new_registers(1, window, horizon), *shared) for _ in positions]
    for k0 in range(0, steps, chunk):
        n = min(chunk, steps - k0)
        for g, rows in enumerate(_in_groups(force, k0 - lead, k0 + n)):
            lanes = slice(g * WIDTH, min((g + 1) * WIDTH, width))
            yield k0, n, lanes, Fed((rows,), k0 - lead, (positions[g],)), memories[g]


def lead_of(chain: Chain) -> int:
    """Return how many rows of the force before a chunk the predictor and the delay need."""
    return max(chain.predictor.steps, chain.filter.input_delay + 1)


def _in_groups(values: Array | OnePassSeries, first: int, stop: int) -> Array:
    """Return the rows first ... stop - 1 of values (rows, lanes) in groups of eight lanes.

    The result has the shape (groups, rows, 8). Rows before row 0 and missing lanes are zero.
    """
    result = aligned(-(-values.shape[1] // WIDTH), stop - first, WIDTH)
    given = values[max(first, 0) : stop]
    for g, rows in enumerate(result):
        some = given[:, g * WIDTH : (g + 1) * WIDTH]
        rows[max(-first, 0) :, : some.shape[1]] = some
    return result
