"""The batch engine: runs chains over all replicates of a block and sums their errors."""

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

#: Steps that kernels process at once: the buffers of eight lanes fit the second-level cache.
CHUNK = 500


class Sums(NamedTuple):
    """Sums over a record, and their numbers of terms.

    products (2 windows, 6 quantities, 3 products, replicates) as in `kernels.sums`; steps and
    innovations (2,): terms per window; squared (steps or 0, replicates): squared position error.
    """

    products: Array
    steps: NDArray[np.int64]
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
    """Each chain's sums; all of them run on a span of the records before the next is made.

    Parameters
    ----------
    settled
        The first settled step.
    amplitude
        At which whole series are run, m; their squared errors are product 2. None for the products
        of the motion's and the noise's errors.
    keep_squared
        Whether the squared position error of each step is kept; only with an amplitude.
    consistency
        Without it NEES is left at zero and its covariances are not computed.
    """
    weights = [weights_of(chain, consistency=consistency) for chain in chains]
    memory = shared_memory(chains, 3 if amplitude is None else 2)

    def run_eight(part: Records, first: int) -> list[tuple[Array, Array]]:
        """The chains' sums and squared errors of replicates first ... first + 7."""
        feed = Feed(part, first, amplitude)
        runs = [
            ChainRun(*pair, feed, settled, *memory, keep=keep_squared)
            for pair in zip(chains, weights, strict=True)
        ]
        for span in feed.spans(max(run.lead for run in runs)):
            for run in runs:
                run.advance(span)
        count = len(feed.indices)
        return [(run.sums[:, :count], run.squared[:, :count]) for run in runs]

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
    """The weights of NEES and NIS; those of NEES are zero without `consistency`."""
    return Weights(
        precision=chain.precision if consistency else np.zeros((chain.gains.rows, 3)),
        innovation=chain.innovation_weight,
        fresh=chain.gains.fresh,
    )


class ChainRun:
    """One chain on eight replicates, fed span by span."""

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
        """Run the whole chunks that the span completes; at the record's end, also the rest."""
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
    """Working memory that some chains use in turn, so that it stays in the cache."""
    chunk = max(chunk_of(chain)[0] for chain in chains)
    window = max(chain.filter.window for chain in chains)
    return new_scratch(groups, chunk, window), new_output(groups, chunk)


def _joined(chain: Chain, steps: int, settled: int, parts: Sequence[tuple[Array, Array]]) -> Sums:
    """Join the parts, each with the sums and squared errors of up to eight replicates."""
    early, whole = (chain.gains.fresh_before(step) for step in (settled, steps))
    products, squared = (np.concatenate(arrays, axis=1) for arrays in zip(*parts, strict=True))
    return Sums(
        products=products.reshape(2, 6, 3, -1),
        steps=np.array([settled, steps - settled]),
        innovations=np.array([early, whole - early]),
        squared=squared,
    )


def arrays_of(chain: Chain) -> ChainArrays:
    """A chain as a structure of arrays for the kernels."""
    return ChainArrays(chain.filter, chain.predictor, chain.mhe)


def chunk_of(chain: Chain) -> tuple[int, int]:
    """Steps of a chunk, and rows of a span that must be kept for the next one.

    The end of a span that fills no whole chunk is processed with the next span. So a chunk's rows
    are kept in addition to those that the predictor and the delay reach back to.
    """
    chunk = max(CHUNK, 2 * chain.filter.window, 2 * chain.predictor.steps)
    return chunk, chunk + lead_of(chain)


class Estimates(NamedTuple):
    """A chunk's estimates: position, velocity and innovation, (steps, lanes) each."""

    position: Array
    velocity: Array
    innovation: Array


def trajectories(
    chain: Chain, sensors: Sensors, force: Array, fixes: Array
) -> tuple[Array, Array, Array]:
    """Estimates of position and velocity and the filter's innovation, (steps, lanes) each.

    Parameters
    ----------
    force, fixes
        (steps, lanes) specific force in NED, m/s^2; (fixes, lanes) positions, m.
    """
    result = (np.empty(force.shape), np.empty(force.shape), np.empty(force.shape))
    for k0, n, output in chunks(chain, force, fixes):
        for out, source in zip(result, output, strict=True):
            out[k0 : k0 + n] = source[:n]
    return result


def chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Estimates]]:
    """Run a chain over lanes chunk by chunk; yields first step, number of steps and estimates.

    The next chunk overwrites the same arrays.
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
    """The filter's states (p, v, a, b), smoothed if the chain has a smoother.

    Row k is the state of step k - window in the filter's time, which lags by the chain's input
    delay (and the fixes' delay). The first `window` rows are zero.

    Returns
    -------
    Array
        (steps, 4, lanes) in m, m/s, m/s^2, m/s^2; b is x4 of Eq. (6), -R b^b + g.
    """
    result = np.empty((force.shape[0], 4, force.shape[1]))
    for k0, n, some in state_chunks(chain, force, fixes):
        result[k0 : k0 + n] = some[:n]
    return result


def state_chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Array]]:
    """`states` chunk by chunk; yields first step, number of steps and (chunk, 4, lanes).

    The next chunk overwrites the same array.
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
    """Go through chunks and groups; yields first step, steps, lanes, inputs and memory."""
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
    """How many rows of the force before a chunk the predictor and the delay need."""
    return max(chain.predictor.steps, chain.filter.input_delay + 1)


def _in_groups(values: Array | OnePassSeries, first: int, stop: int) -> Array:
    """Rows first ... stop - 1 in groups of eight lanes, (groups, rows, 8); zeros before row 0."""
    result = aligned(-(-values.shape[1] // WIDTH), stop - first, WIDTH)
    given = values[max(first, 0) : stop]
    for g, rows in enumerate(result):
        some = given[:, g * WIDTH : (g + 1) * WIDTH]
        rows[max(-first, 0) :, : some.shape[1]] = some
    return result
