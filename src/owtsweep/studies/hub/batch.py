"""The batch engine: runs chains on simulated records and sums the chains' squared errors.

A chain is a scheme in the form of arrays for compiled kernels. A lane is one series along one axis,
x or y. A group is eight lanes, which kernels run at once.
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
    """The sums of one scheme's squared errors over each record, and the numbers of summed terms.

    The error of an estimate is the error from motion plus the error from noise.

    Attributes
    ----------
    products
        Sums over the steps, shape (2, 6, 3, replicates). The axes are: steps before and after the
        settling time; x, y, vx, vy, NEES, NIS; products of the errors from motion x motion,
        motion x noise, noise x noise. SI units.
    steps, covariances, innovations
        Number of steps, number of steps for which the scheme states the covariance of its estimate,
        and number of innovations, before and after the settling time, shape (2,)
        each.
    squared
        Squared position error of each step, m^2, shape (steps, replicates). The shape is
        (0, replicates) if `sum_errors` was called without `keep_squared`.
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
    """Run schemes on all replicates of some records; sum the squared errors of each scheme.

    The records are made span by span (10 000 steps each). All schemes run on one span before the
    next span is made. A scheme whose estimates follow straight lines does not run if motion and
    noise are apart: its errors are summed by `fix_lines`.

    Parameters
    ----------
    chains
        The schemes, in the form of arrays for kernels.
    records
        The records, which are simulated during the run.
    settled
        Number of the first step after the settling time.
    amplitude
        Amplitude of the motion, m. With an amplitude, motion plus noise is run as one series, and
        the square of its error is stored as the product noise x noise. If None, motion and noise
        are run separately, and all three products of the two errors are summed.
    keep_squared
        Whether the squared position error of each step is kept; only with an amplitude.
    consistency
        Whether NEES is computed; otherwise NEES is zero.

    Returns
    -------
    list of Sums
        One entry per scheme, in the order of `chains`.
    """
    lines = {chain: chain.line for chain in chains if chain.line and amplitude is None}
    others = [chain for chain in chains if chain not in lines]
    weights = [weights_of(chain, consistency=consistency) for chain in others]
    memory = shared_memory(others, 3 if amplitude is None else 2)

    def run_eight(part: Records, first: int) -> list[tuple[Array, Array]]:
        """Return each chain's sums and kept squared errors for the replicates first to first + 7.

        `first` is an index in `part`, which may have fewer replicates left.
        """
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
    """Return the weights by which kernels make NEES and NIS from a scheme's errors.

    `chain` is the scheme in the form of arrays for kernels. If `consistency` is False, the weights
    for NEES are zero.
    """
    return Weights(
        precision=chain.precision if consistency else np.zeros((chain.gains.rows, 3)),
        innovation=chain.innovation_weight,
        fresh=chain.gains.fresh,
    )


class ChainRun:
    """A run of one scheme on up to eight replicates, whose records arrive piece by piece.

    Parameters
    ----------
    chain, weights
        The scheme in its form for the batch engine, and its weights for NEES and NIS.
    feed
        The source of the records.
    settled
        Number of the first step after the settling time.
    scratch, output
        Working memory, which several runs may use in turn.
    keep
        Whether the squared position error of each step is kept.
    """

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
        """Run the scheme on the next span of the records; add the errors' products to `self.sums`.

        Kernels process whole chunks of `self.chunk` steps. Steps at the end of the span that fill
        no chunk wait for the next span, unless the record ends with this span.
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
    """Return arrays that kernels use as scratch, and arrays to which kernels write estimates.

    All chains (schemes in the form of arrays) use these arrays in turn, so that the arrays stay in
    the processor's cache. `groups` is the number of groups of eight series that run at once.
    """
    chunk = max((chunk_of(chain)[0] for chain in chains), default=0)
    window = max((chain.filter.window for chain in chains), default=0)
    return new_scratch(groups, chunk, window), new_output(groups, chunk)


def _joined(chain: Chain, steps: int, settled: int, parts: Sequence[tuple[Array, Array]]) -> Sums:
    """Join the results of one scheme for parts of the replicates into one `Sums`.

    Each element of `parts` holds the sums and the squared errors of up to eight replicates. `chain`
    is the scheme for the batch engine, `steps` the length of a record, and `settled` the number of
    the first step after the settling time.
    """
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
    """Return those arrays of a chain (a scheme for the batch engine) that kernels take."""
    return ChainArrays(chain.filter, chain.predictor, chain.mhe)


def chunk_of(chain: Chain) -> tuple[int, int]:
    """Return how many steps kernels process at once, and how many rows the next span must repeat.

    The steps that are processed at once are a chunk. A span is the piece of the records that is in
    memory, with one row per step. Steps at the end of a span that fill no chunk are processed with
    the next span. So the next span repeats the rows of one chunk, and the rows before that chunk to
    which the predictor and the input delay reach back.
    """
    chunk = max(CHUNK, 2 * chain.filter.window, 2 * chain.predictor.steps)
    return chunk, chunk + lead_of(chain)


class Estimates(NamedTuple):
    """The estimates of successive steps: position, velocity and innovation, (steps, lanes) each.

    A lane is one series along one axis. The units are m, m/s and m.
    """

    position: Array
    velocity: Array
    innovation: Array


def trajectories(
    chain: Chain, sensors: Sensors, force: Array, fixes: Array
) -> tuple[Array, Array, Array]:
    """Run a chain over whole records; return its estimates at each step.

    A chain is a scheme in the form of arrays for kernels. A lane is one series along one axis.

    Parameters
    ----------
    sensors
        Not used.
    force, fixes
        Specific force in NED, m/s^2, shape (steps, lanes), and position fixes in NED, m, shape
        (fixes, lanes).

    Returns
    -------
    tuple of array
        Estimated position (m) and velocity (m/s), and the filter's innovation (m), shape
        (steps, lanes) each.
    """
    result = (np.empty(force.shape), np.empty(force.shape), np.empty(force.shape))
    for k0, n, output in chunks(chain, force, fixes):
        for out, source in zip(result, output, strict=True):
            out[k0 : k0 + n] = source[:n]
    return result


def chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Estimates]]:
    """Run a chain over series; yield the estimates of successive chunks of steps.

    A chain is a scheme in the form of arrays for kernels. `force` is specific force in NED, m/s^2,
    shape (steps, lanes); `fixes` are position fixes in NED, m, shape (fixes, lanes). A lane is one
    series along one axis.

    Yields
    ------
    tuple
        The chunk's first step, its number of steps n, and the estimates, of which the first n rows
        are valid. The next chunk overwrites the estimates.
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

    A chain is a scheme in the form of arrays for kernels. `force` is specific force in NED, m/s^2,
    shape (steps, lanes); `fixes` are position fixes in NED, m, shape (fixes, lanes). A lane is one
    series along one axis.

    Returns
    -------
    Array
        Shape (steps, 4, lanes): position (m), velocity (m/s), acceleration and b (m/s^2). Here b
        is the state x4 = -R b^b + g of Eq. (6) of Ren et al. (2019): bias and gravity. Row k is the
        state of step k - D - W, where D is the chain's input delay and W its smoother's lag, both
        in steps. The first W rows are zero.
    """
    result = np.empty((force.shape[0], 4, force.shape[1]))
    for k0, n, some in state_chunks(chain, force, fixes):
        result[k0 : k0 + n] = some[:n]
    return result


def state_chunks(
    chain: Chain, force: Array | OnePassSeries, fixes: Array
) -> Iterator[tuple[int, int, Array]]:
    """Compute the rows that `states` returns, but yield them in chunks of successive rows.

    Parameters are those of `states`; `force` may be made during the run.

    Yields
    ------
    tuple
        The number of the chunk's first row, its number of rows n, and the states, shape
        (rows, 4, lanes), of which the first n rows are valid. The next chunk overwrites the states.
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
    """Cut series into pieces that kernels process at once: a chunk of steps, and eight lanes.

    A lane is one series along one axis. For each piece, yield its first step, its number of steps,
    the indices of its lanes, and the inputs and the memory for the kernels. The pieces of one chunk
    follow each other.
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
    """Return how many samples of the specific force kernels need from before their first step.

    The predictor and the input delay of the chain (a scheme's arrays) reach back so far.
    """
    return max(chain.predictor.steps, chain.filter.input_delay + 1)


def _in_groups(values: Array | OnePassSeries, first: int, stop: int) -> Array:
    """Return rows `first` to `stop` - 1 of values (rows, lanes), regrouped: (groups, rows, 8).

    Each group has eight of the lanes (columns). Zeros stand for rows before row 0, and for the
    lanes that the last group lacks.
    """
    result = aligned(-(-values.shape[1] // WIDTH), stop - first, WIDTH)
    given = values[max(first, 0) : stop]
    for g, rows in enumerate(result):
        some = given[:, g * WIDTH : (g + 1) * WIDTH]
        rows[max(-first, 0) :, : some.shape[1]] = some
    return result
