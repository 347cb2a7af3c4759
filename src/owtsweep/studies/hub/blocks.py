"""Runs blocks, the units of work of the hub study that `planning` makes.

A block holds the cases of one scheme under one combination of conditions, e.g. at one natural
period, for up to eight replicates.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import groupby, pairwise

import numpy as np
import pandas as pd

from owtsweep.errors import as_text
from owtsweep.evaluation.loop import run_estimator
from owtsweep.results.conditions import Value
from owtsweep.studies.hub import measures
from owtsweep.studies.hub.batch import Sums, sum_errors
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.conditions import list_condition_names
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.known import Estimator, Known
from owtsweep.studies.hub.names import list_entries
from owtsweep.studies.hub.records import Records, make_records_at
from owtsweep.studies.hub.resolving import resolve_all, under
from owtsweep.studies.hub.sensors import Measurements, observe
from owtsweep.sweep.study import Block


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
    return runs_chain(config, scheme) or runs_itself(config, scheme)


def runs_chain(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs as a `Chain`, beside other chains."""
    return _suits_kernels(config) and scheme.batched == "chain"


def runs_itself(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs by a compiled kernel of its own, an `OwnKernel`."""
    return _suits_kernels(config) and scheme.batched == "own"


def _suits_kernels(config: HubConfig) -> bool:
    return config.engine == "batch" and not config.sensors.gnss.loses


def start(scheme: Scheme, known: Known) -> Estimator:
    """Return a new estimator of a scheme, which runs step by step.

    With the key engine=batch, the estimator is compiled if the scheme has a compiled one.
    """
    return scheme.stream(known) if known.tuning.engine == "batch" else scheme.start(known)


def tell(
    scheme: Scheme, known: Known, conditions: Mapping[str, Value], amplitude: float | None
) -> Known:
    """Return what a scheme knows: with the motion of the case, if it must be told."""
    if not scheme.told_motion:
        return known
    return replace(known, natural_period=float(conditions["natural_period"]), amplitude=amplitude)


def run(config: HubConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group; yield each block with its rows.

    Motion and noise are made once for all successive blocks of some replicates, of all tunings.
    """
    conditions = {name: blocks[0].content[name] for name in list_condition_names(config)}
    for replicates, of_records in groupby(blocks, lambda block: block.content["replicates"]):
        records = make_records_at(config, conditions, replicates)
        for _, of_tuning in groupby(of_records, lambda block: block.tunings[:1]):
            chosen = list(of_tuning)
            yield from _run_one_tuning(chosen[0].choose(config), chosen, records)


def _run_one_tuning(
    config: HubConfig, blocks: Sequence[Block], records: Records
) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one tuning; yield each block with its rows.

    Schemes with a kernel run together on each span of the records, while the span is in the
    processor's cache. So the first block of an amplitude (or the first superposed block) runs all
    schemes that have blocks of this kind.
    """
    schemes = {s.name: under(s, config) for s in resolve_all(list_entries(config))}
    ready: dict[int, pd.DataFrame | Exception] = {}
    for number, block in enumerate(blocks):
        scheme, amplitude = schemes[block.content["scheme"]], block.content.get("amplitude")
        known = tell(scheme, Known(records.sensors, config), records.conditions, amplitude)
        if runs_itself(config, scheme):
            rows = _by_own_kernel(scheme, known, records, block.content["amplitude"])
        elif runs_chain(config, scheme):
            if number not in ready:
                together = {
                    later: schemes[other.content["scheme"]]
                    for later, other in enumerate(blocks[number:], number)
                    if other.content.get("amplitude") == amplitude
                    and runs_chain(config, schemes[other.content["scheme"]])
                }
                ready.update(_by_kernels(config, together, records, amplitude))
            result = ready.pop(number)
            if isinstance(result, Exception):
                raise result
            rows = result
        else:
            settled = _settled(config, records)
            (rows,) = _frames([_by_loop(scheme, known, records, settled, amplitude)])
        yield block, rows


def _settled(config: HubConfig, records: Records) -> int:
    """Return the number of the first step after the settling time."""
    return round(config.measures.settling_time / records.sensors.step)


def _frames(parts: Sequence[Iterable[measures.Columns]]) -> list[pd.DataFrame]:
    """Return one DataFrame per element of `parts`.

    An element yields tables (column name -> values), whose rows the DataFrame joins. One large
    DataFrame is made and then cut, because pandas is slow to make many DataFrames.
    """
    tables = [list(part) for part in parts]
    pieces = [piece for part in tables for piece in part]
    whole = pd.DataFrame({name: _joined([p[name] for p in pieces]) for name in pieces[0]})
    stops = np.cumsum([sum(len(piece["value"]) for piece in part) for part in tables]).tolist()
    result = [whole.iloc[first:stop] for first, stop in pairwise([0, *stops])]
    for frame in result:
        frame.index = pd.RangeIndex(len(frame))
    return result


def _joined(columns: list[measures.Column]) -> measures.Column:
    if isinstance(columns[0], list):
        return [word for column in columns if isinstance(column, list) for word in column]
    return np.concatenate(columns)


def _by_kernels(
    config: HubConfig,
    schemes: Mapping[int, Scheme],
    records: Records,
    amplitude: float | None,
) -> dict[int, pd.DataFrame | Exception]:
    """Run schemes by kernels; return the number of each scheme -> its rows, or an exception.

    An exception comes from making the scheme's arrays for kernels, or from running the scheme.

    Parameters
    ----------
    schemes
        Number -> scheme. The numbers only identify the schemes in the result.
    amplitude
        Amplitude of the motion, m; None to run motion and noise separately for all amplitudes.
    """
    made = dict(zip(schemes, _chains(config, list(schemes.values()), records), strict=True))
    chains = {n: chain for n, chain in made.items() if not isinstance(chain, Exception)}
    # raised later, when its block is due
    failed: dict[int, pd.DataFrame | Exception] = {
        n: error for n, error in made.items() if isinstance(error, Exception)
    }
    if not chains:
        return failed
    try:
        return failed | _run_chains(config, schemes, chains, records, amplitude)
    except Exception as error:
        if len(chains) == 1:
            return failed | dict.fromkeys(chains, error)
    # the chain of one scheme is no good: each alone, so that the others' results are not lost
    for number in chains:
        failed |= _by_kernels(config, {number: schemes[number]}, records, amplitude)
    return failed


def _run_chains(
    config: HubConfig,
    schemes: Mapping[int, Scheme],
    chains: Mapping[int, Chain],
    records: Records,
    amplitude: float | None,
) -> dict[int, pd.DataFrame]:
    """Run chains side by side; return the number of each chain -> rows of the scheme.

    A chain is a scheme in the form of arrays for kernels. `chains` maps numbers to chains, and
    `schemes` maps the same numbers to the schemes. `amplitude` is in m; None runs motion and noise
    separately for all amplitudes.
    """
    settled = _settled(config, records)
    keep = config.measures.extremes
    sums = sum_errors(list(chains.values()), records, settled, amplitude, keep_squared=keep)
    tables = [
        _from_sums(of_scheme, schemes[number].name, records, amplitude)
        for number, of_scheme in zip(chains, sums, strict=True)
    ]
    return dict(zip(chains, _frames(tables), strict=True))


def _by_own_kernel(
    scheme: Scheme, known: Known, records: Records, amplitude: float
) -> pd.DataFrame:
    """Run a scheme by a kernel of its own at an amplitude (m); return the rows."""
    kernel, config = scheme.own_kernel(known, records.steps), known.tuning
    keep = config.measures.extremes
    sums = kernel.sum_errors(records, _settled(config, records), amplitude, keep_squared=keep)
    (rows,) = _frames([_from_sums(sums, scheme.name, records, amplitude)])
    return rows


def _chains(
    config: HubConfig, schemes: Sequence[Scheme], records: Records
) -> Iterable[Chain | Exception]:
    """Make the chain of each scheme, its form for the kernels; use threads if cores are free.

    The result has the order of `schemes`. If making a chain raises an exception, the result has
    this exception in place of the chain. KeyboardInterrupt is raised.
    """

    known = Known(records.sensors, config)

    def made(scheme: Scheme) -> Chain | Exception:
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

    threads = min(_threads(config, schemes), len(schemes))
    if threads == 1:
        return map(made, schemes)
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(made, schemes))


def _threads(config: HubConfig, schemes: Sequence[Scheme]) -> int:
    """Return how many threads may prepare schemes for the kernels at once.

    If the sweep runs in threads, the result is the number of the sweep's workers, because the
    workers would otherwise wait. If the sweep runs in processes or on a cluster, the result is 1.
    """
    from joblib import cpu_count

    compute = config.compute
    if compute.backend not in ("auto", "threading") or backend(config, schemes) != "threading":
        return 1
    return compute.workers or int(cpu_count())


def _from_sums(
    sums: Sums, scheme: str, records: Records, amplitude: float | None
) -> Iterator[measures.Columns]:
    conditions, replicates = records.conditions, records.replicates
    finite = np.all(np.isfinite(sums.products), axis=(0, 1, 2))
    if finite.all():
        yield measures.table(conditions, replicates, scheme, measures.from_sums(sums), amplitude)
        return
    for index, replicate in enumerate(replicates):
        if finite[index]:
            measured = measures.from_sums(sums, [index])
            yield measures.table(conditions, [replicate], scheme, measured, amplitude)
        else:
            reason = "the estimate is not finite"
            yield measures.failed(conditions, replicate, scheme, reason, amplitude)


def _by_loop(
    scheme: Scheme,
    known: Known,
    records: Records,
    settled: int,
    amplitude: float | None,
) -> Iterator[measures.Columns]:
    conditions = records.conditions
    for part in records.parts():
        for index, replicate in enumerate(part.replicates):
            try:
                with np.errstate(over="ignore", invalid="ignore"):  # told as the reason
                    measured = _looped(scheme, known, part, settled, amplitude, index)
                if not np.all(np.isfinite(measured.products)):
                    raise ValueError("squares of the errors are too large, or no numbers")
                rows = measures.table(conditions, [replicate], scheme.name, measured, amplitude)
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # a user's scheme may raise anything
                rows = measures.failed(
                    conditions, replicate, scheme.name, as_text(error), amplitude
                )
            yield rows


def _looped(
    scheme: Scheme,
    known: Known,
    records: Records,
    settled: int,
    amplitude: float | None,
    index: int,
) -> measures.Measured:
    sensors = records.sensors
    motion, noise = records.motion[index], records.noise[index]
    observed = observe(motion, records.direction, sensors)
    truth = np.concatenate(
        [np.outer(s, records.direction) for s in (motion.position, motion.velocity)], axis=1
    )
    # what is lost with the noise is lost with the motion
    observed.fixes[np.isnan(noise.fixes)] = np.nan
    if amplitude is None:
        responses = [
            run_estimator(start(scheme, known), *part, sensors.fix_interval)
            for part in (observed, noise)
        ]
        return measures.from_trajectories(responses[0], responses[1], truth, settled)
    whole = Measurements(
        amplitude * observed.specific_force + noise.specific_force,
        amplitude * observed.fixes + noise.fixes,
    )
    response = run_estimator(start(scheme, known), *whole, sensors.fix_interval)
    extremes = known.tuning.measures.extremes
    return measures.from_trajectories(None, response, amplitude * truth, settled, extremes=extremes)
