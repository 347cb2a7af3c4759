"""The batch engine: runs chains on simulated records and sums the chains' squared errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from owtsweep.arrays import Array, Rows, aligned, make_mixed_rows, make_rows
from owtsweep.errors import as_text, require
from owtsweep.results.conditions import Value
from owtsweep.results.status import FAILED
from owtsweep.studies.base.declaration import Judgement, Means
from owtsweep.studies.hub import measures
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, Scheme
from owtsweep.studies.hub.kernels.layout import (
    STATE,
    WIDTH,
    ChainArrays,
    Fed,
    Memory,
    Truth,
    Weights,
)
from owtsweep.studies.hub.measures import Sums
from owtsweep.studies.hub.records import Feed, Records, Span
from owtsweep.studies.hub.sensors import sensors as make_sensors
from owtsweep.studies.hub.worlds import find_amplitude, find_world

#: Number of steps that kernels process at once, a chunk: so few that their rows fit the
#: second-level cache.
CHUNK = 500


def sum_errors(
    chains: Sequence[Chain],
    records: Records,
    settled: int,
    amplitude: float | None = None,
    *,
    keep_squared: bool = False,
) -> list[Sums]:
    """Run chains on all replicates of some records; sum the squared errors of each, in their order.

    All chains run on one span before the next is made.

    settled: number of the first step after the settling time.
    amplitude: of the motion, m: motion plus noise is run as one series, and the square of its error
        is stored as the product noise x noise. None: motion and noise are run separately, and all
        three products of the two errors are summed.
    keep_squared: whether the squared position error of each step is kept; only with an amplitude.
    Raises InputError if fixes may be lost: a chain has the gains for fixes that all arrive.
    """
    require(
        not records.config.sensors.gnss.loses,
        "sensors.gnss.loss: kernels need every fix; run a `sweep`, which then goes step by step, "
        "or set the probability to 0",
    )
    eights = []
    for feed in records.feed(amplitude):
        runs = [ChainRun(chain, feed, settled, keep=keep_squared) for chain in chains]
        for span in feed.spans(max(run.lead for run in runs)):
            for run in runs:
                run.advance(span)
        some = slice(len(feed.indices))
        eights.append([(run.products[..., some], run.squared[:, some]) for run in runs])
    return [
        measures.join_sums(
            parts, settled, records.steps, chain.gains.fresh_before, chain.has_covariance
        )
        for chain, parts in zip(chains, zip(*eights, strict=True), strict=True)
    ]


def weights_of(chain: Chain) -> Weights:
    """Return the weights by which kernels make NEES and NIS from a chain's errors."""
    return Weights(chain.precision, 1.0 / chain.gains.innovation_variance, chain.gains.fresh)


class ChainRun:
    """A run of one chain on up to eight replicates, whose records arrive span by span.

    settled: number of the first step after the settling time.
    keep: whether the squared position error of each step is kept.
    """

    def __init__(self, chain: Chain, feed: Feed, settled: int, *, keep: bool = False) -> None:
        self.feed, self.settled = feed, settled
        self.weights, self.steps = weights_of(chain), feed.records.steps
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
        """The sums as `products` arranges them, shape (2, 6, 3, WIDTH)."""
        return products(self.sums, self.direction)

    def advance(self, span: Span) -> None:
        """Run the chain on the next span of the records; add the errors' products to `self.sums`.

        Kernels take whole chunks. Steps at the end of the span that fill no chunk wait for the next
        span, unless the record ends with this one.
        """
        from owtsweep.studies.hub.kernels.chain import run

        ready = span.stop if span.stop == self.steps else span.stop // self.chunk * self.chunk
        stretch = (self.done, ready, self.chunk, self.settled)
        fed, truth = Fed(span.force, span.base, self.feed.fixes), Truth(span.motion, self.direction)
        work = (stretch, fed, truth, self.arrays, self.weights, self.memory)
        run(*work, self.sums, self.squared)
        self.done = ready


def arrays_of(chain: Chain) -> ChainArrays:
    """Return those arrays of a chain that kernels take."""
    return ChainArrays(chain.filter, chain.predictor, chain.mhe)


def chunk_of(chain: Chain) -> tuple[int, int]:
    """Return the length of a chunk in steps, and how many rows the next span must repeat.

    The rows are those of one chunk, for steps at the end of a span that fill none wait for the
    next, and those before it to which the predictor and the input delay reach back.
    """
    chunk = max(CHUNK, 2 * chain.filter.window, 2 * chain.predictor.steps)
    return chunk, chunk + lead_of(chain)


def lead_of(chain: Chain) -> int:
    """Return how many samples of the specific force kernels need from before their first step."""
    return max(chain.predictor.steps, chain.filter.input_delay + 1)


def new_memory(chain: ChainArrays, lanes: int, chunk: int) -> Memory:
    """Make the memory for a run of `lanes` lanes, in chunks of at most `chunk` steps."""
    return Memory(
        steps=make_rows(chain.filter.window + 1 + chunk, lanes, "r", "s", *STATE),
        back=make_rows(1, lanes, *STATE),
        inputs=make_rows(1, lanes, "p", "v"),
        nodes=make_rows(chain.mhe.horizon + 1, lanes, "z", "ip", "iv", "p", "v", "b"),
        now=make_rows(1, lanes, "gathered", "sample", "np", "nv", "nb", "p", "v"),
        position=aligned(1, lanes),
    )


#: The sums of squared errors: of position, of velocity, in NEES and in NIS. The ending says of
#: what: m is motion, x and y are noise along an axis, and xx of NEES and NIS is both axes.
SUMS = (
    "mm", "mx", "my", "xx", "yy", "vmm", "vmx", "vmy", "vxx", "vyy", "nmm", "nmx", "nxx", "imm",
    "imx", "ixx",
)  # fmt: skip


def new_sums(lanes: int) -> Rows:
    """Make sums, all zero, for a run of `lanes` lanes: one row before and one after settling.

    The fields p, v, motion and square are those of the step whose errors are being added. Kernels
    copy them into the row of the sums, because the compiler knows that fields of one row do not
    overlap.
    """
    own = [("p", lanes), ("v", lanes), ("motion", 2 * WIDTH), ("square", WIDTH)]
    return make_mixed_rows(own + [(name, WIDTH) for name in SUMS], 2)


def products(sums: Rows, direction: Array) -> Array:
    """Arrange sums as (2, 6, 3, WIDTH): part of the record, quantity, product, replicate.

    The parts are before and after settling; the quantities x, y, vx, vy, NEES, NIS; the products
    motion x motion, motion x noise, noise x noise. `direction` (2,) is that of `Truth`.
    """
    cx, cy = direction
    result = np.empty((2, 6, 3, WIDTH))
    for quantity, v in ((0, ""), (2, "v")):
        for axis, (c, name) in enumerate(((cx, "x"), (cy, "y"))):
            row = result[:, quantity + axis]
            row[:, 0] = c * c * sums[f"{v}mm"]
            row[:, 1] = c * sums[f"{v}m{name}"]
            row[:, 2] = sums[f"{v}{name}{name}"]
    for quantity, n in ((4, "n"), (5, "i")):
        for product, name in enumerate(("mm", "mx", "xx")):
            result[:, quantity, product] = sums[n + name]
    return result


#: What a scheme's estimates of each record are worth, or the exception that it has raised.
Result = list[Judgement[Means]] | Exception


def backend(config: HubConfig, schemes: Sequence[Scheme]) -> str:
    """Return "threading" if all schemes run by compiled kernels, else "loky" (processes).

    Kernels release the GIL.
    """
    compiled = all(uses_kernels(config, scheme) for scheme in schemes)
    return "threading" if compiled else "loky"


def uses_kernels(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs by a compiled kernel; only the batch engine uses kernels.

    A kernel has the gains for fixes that all arrive. So where fixes may be lost, schemes run step
    by step.
    """
    return config.engine == "batch" and not config.sensors.gnss.loses and scheme.batched != ""


def know(config: HubConfig, cell: Mapping[str, Value]) -> Known:
    """Return what schemes may know of a cell.

    With motion=plant and sensors.imu.tilt=structure, the tilt is the slope of the first mode,
    rad/m.
    """
    world, period = find_world(config), cell.get("natural_period")
    source = world.make_source(config, cell)
    sensors = world.fit_sensors(source, make_sensors(config.sensors), config)
    known_period = None if period is None else float(period)
    return Known(sensors, config, known_period, find_amplitude(config, cell))


def run_batch(
    config: HubConfig, cell: Mapping[str, Value], records: Records, schemes: Sequence[Scheme]
) -> list[Result]:
    """Run schemes by kernels; return for each what its estimates of each record are worth.

    Chains run together on each span, while it is in the processor's cache. Motion and noise are
    apart in a cell without an amplitude.
    """
    known = know(config, cell)
    found = _run_chains(known, [each for each in schemes if each.batched == "chain"], records)
    for scheme in schemes:
        if scheme.batched == "own":
            found[scheme.name] = _run_own_kernel(scheme, known, records)
    return [found[scheme.name] for scheme in schemes]


def _run_own_kernel(scheme: Scheme, known: Known, records: Records) -> Result:
    judged, amplitude = known.tuning.measures, known.amplitude
    assert amplitude is not None  # such schemes run at each
    settled, keep = judged.find_settled(records.sensors.step), judged.extremes
    try:
        kernel = scheme.own_kernel(scheme.tell(known), records.steps)
        return _judge(kernel.sum_errors(records, settled, amplitude, keep_squared=keep))
    except Exception as error:
        return error


def _run_chains(known: Known, schemes: Sequence[Scheme], records: Records) -> dict[str, Result]:
    judged = known.tuning.measures
    failed: dict[str, Result] = {}
    chains: dict[str, Chain] = {}
    made = _make_chains(Known(known.sensors, known.tuning), schemes, records)
    for scheme, chain in zip(schemes, made, strict=True):
        if isinstance(chain, Chain):
            chains[scheme.name] = chain
        else:
            failed[scheme.name] = chain
    if not chains:
        return failed
    settled, keep = judged.find_settled(records.sensors.step), judged.extremes
    try:
        sums = sum_errors([*chains.values()], records, settled, known.amplitude, keep_squared=keep)
    except Exception as error:
        if len(chains) == 1:
            return failed | dict.fromkeys(chains, error)
    else:
        return failed | dict(zip(chains, map(_judge, sums), strict=True))
    # the chain of one scheme is no good: each alone, so that the others' results are not lost
    for scheme in schemes:
        if scheme.name in chains:
            failed |= _run_chains(known, [scheme], records)
    return failed


def _make_chains(
    known: Known, schemes: Sequence[Scheme], records: Records
) -> Iterable[Chain | Exception]:
    """Make the chain of each scheme, or get the exception; use threads if cores are free."""

    def make(scheme: Scheme) -> Chain | Exception:
        try:
            chain: object = scheme.kernel_for_runs(known, records.steps)
        except KeyboardInterrupt:
            raise
        except Exception as error:
            return error
        except BaseException as error:  # a user's kernel may call sys.exit()
            return RuntimeError(as_text(error))
        if not isinstance(chain, Chain):
            return TypeError(f"its kernel gives a {type(chain).__name__}, not a Chain")
        return chain

    threads = min(_count_threads(known.tuning, schemes), len(schemes))
    if threads <= 1:
        return map(make, schemes)
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(make, schemes))


def _count_threads(config: HubConfig, schemes: Sequence[Scheme]) -> int:
    """Return how many threads may prepare schemes for the kernels at once.

    In a threaded sweep they are as many as its workers, which would otherwise wait; else 1.
    """
    from joblib import cpu_count

    compute = config.compute
    if compute.backend not in ("auto", "threading") or backend(config, schemes) != "threading":
        return 1
    return compute.workers or int(cpu_count())


def _judge(sums: Sums) -> list[Judgement[Means]]:
    finite = np.all(np.isfinite(sums.products), axis=(0, 1, 2))
    return [
        Judgement(means) if good else Judgement(None, FAILED, "the estimate is not finite")
        for means, good in zip(measures.from_sums(sums), finite, strict=True)
    ]
