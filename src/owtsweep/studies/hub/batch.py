"""The batch engine: runs chains on simulated records and sums the chains' squared errors.

A chain is a scheme in the form of arrays for compiled kernels. A lane is one series along one axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.feed import Feed, Span
from owtsweep.studies.hub.feed import Lanes as Lanes  # imported from here elsewhere
from owtsweep.studies.hub.fix_lines import sum_line_errors
from owtsweep.studies.hub.kernels.layout import (
    WIDTH,
    ChainArrays,
    Fed,
    Truth,
    Weights,
    new_memory,
    new_sums,
    products,
)
from owtsweep.studies.hub.records import Records

#: Number of steps that kernels process at once, a chunk: so few that their rows fit the
#: second-level cache.
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


class OwnKernel(Protocol):
    """A scheme in a form for the batch engine that is no `Chain`: it runs itself."""

    def sum_errors(
        self, records: Records, settled: int, amplitude: float, *, keep_squared: bool = False
    ) -> Sums:
        """Run all replicates of some records, motion plus noise; sum the squared errors.

        `settled` is the number of the first step after the settling time, `amplitude` that of the
        motion in m. With `keep_squared`, the squared position error of each step is kept. The sums
        are those of `sum_errors` with an amplitude.
        """
        ...


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

    Raises
    ------
    InputError
        If fixes may be lost: the gains of a chain are those for fixes that all arrive.
    """
    require(
        not records.config.sensors.gnss.loses,
        "sensors.gnss.loss: kernels need every fix; run a `sweep`, which then goes step by step, "
        "or set the probability to 0",
    )
    lines = {chain: chain.line for chain in chains if chain.line and amplitude is None}
    others = [chain for chain in chains if chain not in lines]
    weights = [weights_of(chain, consistency=consistency) for chain in others]

    def run_eight(part: Records, first: int) -> list[tuple[Array, Array]]:
        """Return each chain's sums and kept squared errors for the replicates first to first + 7.

        `first` is an index in `part`, which may have fewer replicates left.
        """
        feed = Feed(part, first, amplitude)
        runs = [
            ChainRun(*pair, feed, settled, keep=keep_squared)
            for pair in zip(others, weights, strict=True)
        ]
        for span in feed.spans(max(run.lead for run in runs)) if runs else ():
            for run in runs:
                run.advance(span)
        arrays: dict[Chain, tuple[Array, Array]] = {
            chain: (run.products, run.squared) for chain, run in zip(others, runs, strict=True)
        }
        sums = sum_line_errors(list(lines.values()), feed, settled) if lines else []
        nothing = np.empty((0, WIDTH))
        arrays |= {chain: (one, nothing) for chain, one in zip(lines, sums, strict=True)}
        some = slice(len(feed.indices))
        return [(arrays[chain][0][..., some], arrays[chain][1][:, some]) for chain in chains]

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
    keep
        Whether the squared position error of each step is kept.
    """

    def __init__(
        self,
        chain: Chain,
        weights: Weights,
        feed: Feed,
        settled: int,
        *,
        keep: bool = False,
    ) -> None:
        self.weights, self.feed, self.settled = weights, feed, settled
        self.steps = feed.records.steps
        self.arrays = arrays_of(chain)
        self.chunk, self.lead = chunk_of(chain)
        self.memory = new_memory(self.arrays, feed.lanes, self.chunk)
        amplitude = 1.0 if feed.amplitude is None else feed.amplitude
        self.direction = feed.records.direction * amplitude
        self.sums = new_sums(feed.lanes)
        self.squared = np.empty((self.steps if keep else 0, WIDTH))
        self.done = 0

    @property
    def products(self) -> Array:
        """The sums as `layout.products` arranges them."""
        return products(self.sums, self.direction)

    def advance(self, span: Span) -> None:
        """Run the scheme on the next span of the records; add the errors' products to `self.sums`.

        Kernels process whole chunks of `self.chunk` steps. Steps at the end of the span that fill
        no chunk wait for the next span, unless the record ends with this span.
        """
        from owtsweep.studies.hub.kernels import runs

        ready = span.stop if span.stop == self.steps else span.stop // self.chunk * self.chunk
        stretch = (self.done, ready, self.chunk, self.settled)
        fed, truth = Fed(span.force, span.base, self.feed.fixes), Truth(span.motion, self.direction)
        work = (stretch, fed, truth, self.arrays, self.weights, self.memory)
        runs.run(*work, self.sums, self.squared)
        self.done = ready


def _joined(chain: Chain, steps: int, settled: int, parts: Sequence[tuple[Array, Array]]) -> Sums:
    """Join the results of one scheme for parts of the replicates into one `Sums`.

    Each element of `parts` holds the sums and the squared errors of up to eight replicates. `chain`
    is the scheme for the batch engine, `steps` the length of a record, and `settled` the number of
    the first step after the settling time.
    """
    early, whole = (chain.gains.fresh_before(step) for step in (settled, steps))
    sums, squared = (np.concatenate(arrays, axis=-1) for arrays in zip(*parts, strict=True))
    lengths = np.array([settled, steps - settled])
    return Sums(
        products=sums,
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


def lead_of(chain: Chain) -> int:
    """Return how many samples of the specific force kernels need from before their first step.

    The predictor and the input delay of the chain (a scheme's arrays) reach back so far.
    """
    return max(chain.predictor.steps, chain.filter.input_delay + 1)
