"""Runs schemes of the hub study by compiled kernels, on some records at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from owtsweep.errors import as_text
from owtsweep.results.conditions import Value
from owtsweep.results.status import FAILED
from owtsweep.studies.base.rows import Judgement, Means
from owtsweep.studies.hub import measures
from owtsweep.studies.hub.batch import Sums, sum_errors
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.conditions import find_amplitude, find_period, list_condition_names
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.records import Records, make_records_at

#: What a scheme's estimates of each record are worth, or the exception that it has raised.
Result = list[Judgement[Means]] | Exception


def backend(config: HubConfig, schemes: Sequence[Scheme]) -> str:
    """Return the joblib backend that suits the schemes: "threading" or "loky" (processes).

    It is "threading" if all schemes run by compiled kernels, which release the GIL.
    """
    compiled = all(uses_kernels(config, scheme) for scheme in schemes)
    return "threading" if compiled else "loky"


def uses_kernels(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs by a compiled kernel; only the batch engine uses kernels.

    The gains of a kernel are those for fixes that all arrive. So where fixes are lost, a scheme
    runs step by step.
    """
    return config.engine == "batch" and not config.sensors.gnss.loses and scheme.batched != ""


def make_records(
    config: HubConfig, cell: Mapping[str, Value], replicates: Sequence[int]
) -> Records:
    """Return the records of a cell, whose motion and noise are made at first use."""
    of_motion = {name: cell[name] for name in list_condition_names(config)}
    return make_records_at(config, of_motion, replicates)


def run_batch(
    config: HubConfig, cell: Mapping[str, Value], records: Records, schemes: Sequence[Scheme]
) -> list[Result]:
    """Run schemes by kernels; return for each what its estimates of each record are worth.

    Chains run together on each span of the records, while it is in the processor's cache. Motion
    and noise are apart in a cell without an amplitude.
    """
    amplitude = find_amplitude(config, cell)
    known = Known(records.sensors, config, find_period(cell), amplitude)
    found: dict[str, Result] = {}
    for scheme in schemes:
        if scheme.batched == "own":
            found[scheme.name] = _run_own_kernel(scheme, scheme.tell(known), records, amplitude)
    chained = [scheme for scheme in schemes if scheme.batched == "chain"]
    found |= _run_chains(config, chained, records, amplitude)
    return [found[scheme.name] for scheme in schemes]


def _run_own_kernel(
    scheme: Scheme, known: Known, records: Records, amplitude: float | None
) -> Result:
    assert amplitude is not None  # such schemes run at each
    judged = known.tuning.measures
    settled, keep = judged.find_settled(records.sensors.step), judged.extremes
    try:
        kernel = scheme.own_kernel(known, records.steps)
        return _judge(kernel.sum_errors(records, settled, amplitude, keep_squared=keep))
    except Exception as error:
        return error


def _run_chains(
    config: HubConfig, schemes: Sequence[Scheme], records: Records, amplitude: float | None
) -> dict[str, Result]:
    made = dict(
        zip((each.name for each in schemes), _make_chains(config, schemes, records), strict=True)
    )
    failed: dict[str, Result] = {
        name: chain for name, chain in made.items() if isinstance(chain, Exception)
    }
    chains = {name: chain for name, chain in made.items() if isinstance(chain, Chain)}
    if not chains:
        return failed
    settled = config.measures.find_settled(records.sensors.step)
    keep = config.measures.extremes
    try:
        sums = sum_errors(list(chains.values()), records, settled, amplitude, keep_squared=keep)
    except Exception as error:
        if len(chains) == 1:
            return failed | dict.fromkeys(chains, error)
    else:
        return failed | dict(zip(chains, map(_judge, sums), strict=True))
    # the chain of one scheme is no good: each alone, so that the others' results are not lost
    for scheme in schemes:
        if scheme.name in chains:
            failed |= _run_chains(config, [scheme], records, amplitude)
    return failed


def _make_chains(
    config: HubConfig, schemes: Sequence[Scheme], records: Records
) -> Iterable[Chain | Exception]:
    """Make the chain of each scheme, or get the exception; use threads if cores are free."""
    known = Known(records.sensors, config)

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

    threads = min(_count_threads(config, schemes), len(schemes))
    if threads <= 1:
        return map(make, schemes)
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(make, schemes))


def _count_threads(config: HubConfig, schemes: Sequence[Scheme]) -> int:
    """Return how many threads may prepare schemes for the kernels at once.

    If the sweep runs in threads, the result is the number of the sweep's workers, because the
    workers would otherwise wait. If the sweep runs in processes or on a cluster, the result is 1.
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
