"""Planning and running the study's blocks."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Any

import numpy as np
import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.studies.base import Block
from owtsweep.studies.hub import measures
from owtsweep.studies.hub.batch import Lanes, direct_sums, superposed_sums
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Estimator, Scheme, Sensors
from owtsweep.studies.hub.loop import run_estimator
from owtsweep.studies.hub.records import Records, make_records
from owtsweep.studies.hub.schemes import resolve, resolve_all, under
from owtsweep.studies.hub.sensors import Measurements, observe

#: Replicates of one block: 0-7, 8-15, ...
REPLICATES_PER_BLOCK = 8


def plan(config: HubConfig) -> list[Block]:
    """One block per period, run of replicates and scheme (and amplitude, when run directly)."""
    shared = shared_content(config)
    schemes = resolve_all(config.schemes, config)
    # Once per scheme: the blocks share these parts, or a large plan would not fit into memory.
    owns = [
        {**shared, **scheme_content(config, entry, scheme)}
        for entry, scheme in zip(config.schemes, schemes, strict=True)
    ]
    blocks = []
    for period in sorted(config.grid.natural_period):
        for first in range(0, config.grid.replicates, REPLICATES_PER_BLOCK):
            last = min(first + REPLICATES_PER_BLOCK, config.grid.replicates)
            replicates = list(range(first, last))
            numbers = f"replicates {first}-{last - 1}" if last - first > 1 else f"replicate {first}"
            group = f"{period:g} s, {numbers}"
            for own, scheme in zip(owns, schemes, strict=True):
                amplitudes = [None] if _superposes(config, scheme) else config.grid.amplitude
                for amplitude in amplitudes:
                    content = {**own, "natural_period": float(period), "replicates": replicates}
                    label = f"{scheme.name}, {group}"
                    if amplitude is not None:
                        content["amplitude"] = float(amplitude)
                        label += f", {amplitude:g} m"
                    per_row = len(config.grid.amplitude) if amplitude is None else 1
                    cases = len(replicates) * per_row
                    blocks.append(Block(group, label, content, cases, per_row))
    return blocks


def _superposes(config: HubConfig, scheme: Scheme) -> bool:
    return config.evaluation == "superposed" and scheme.linear


def shared_content(config: HubConfig) -> dict[str, Any]:
    """What every block depends on; never the grid's lists."""
    whole = as_mapping(config)
    keys = (
        "seed",
        "engine",
        "record",
        "spectrum",
        "normalise",
        "band",
        "wave_direction",
        "sensors",
    )
    content = {key: whole[key] for key in keys}
    content["settling_time"] = config.measures.settling_time
    content["extremes"] = config.measures.extremes
    return content


def scheme_content(config: HubConfig, entry: Any, scheme: Scheme) -> dict[str, Any]:
    """What a scheme's rows depend on: its sections of the tuning, or all for a user's scheme."""
    sections = getattr(scheme, "sections", ("ekf", "mkf", "hme1", "hme2", "hme"))
    tuning = {section: _plain(attrgetter(section)(config)) for section in sections}
    content: dict[str, Any] = {"scheme": scheme.name, "tuning": tuning}
    if isinstance(entry, Mapping):
        content["entry"] = {str(key): value for key, value in entry.items()}
        content["source"] = _source_hash(scheme)
    return content


def _plain(section: Any) -> Any:
    return as_mapping(section) if hasattr(section, "__dataclass_fields__") else section


def _source_hash(scheme: Scheme) -> str:
    """A user's scheme is known by the source of its module, so an edit is a new scheme."""
    try:
        source = inspect.getsource(inspect.getmodule(type(scheme)) or type(scheme))
    except (OSError, TypeError):
        return "unknown"
    return hashlib.blake2b(source.encode(), digest_size=8).hexdigest()


def uses_kernels(config: HubConfig, scheme: Scheme) -> bool:
    """Whether the batch engine runs the scheme's own kernel."""
    return config.engine == "batch" and hasattr(scheme, "kernel")


def start(config: HubConfig, scheme: Any, sensors: Sensors) -> Estimator:
    """An estimator to be fed step by step: compiled in the batch engine, where there is such."""
    if config.engine == "batch" and hasattr(scheme, "stream"):
        return scheme.stream(sensors, config)  # type: ignore[no-any-return]
    return scheme.start(sensors, config)  # type: ignore[no-any-return]


def run(config: HubConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group; motion and noise are made once for all of them."""
    records: Records | None = None
    lanes: Lanes | None = None
    entries = {resolve(entry).name: entry for entry in config.schemes}
    for block in blocks:
        content = block.content
        if records is None or lanes is None:
            records = make_records(config, content["natural_period"], content["replicates"])
            lanes = Lanes(records)
        scheme = under(resolve(entries[content["scheme"]]), config)
        amplitude = content.get("amplitude")
        settled = round(config.measures.settling_time / records.sensors.step)
        arguments = (config, scheme, records, settled, amplitude)
        if uses_kernels(config, scheme):
            rows = list(_by_kernel(*arguments, content["natural_period"], lanes))
        else:
            rows = list(_by_loop(*arguments, content["natural_period"]))
        yield block, _frame(rows)


def _frame(rows: list[dict[str, Any]]) -> pd.DataFrame:
    table = pd.DataFrame(rows, columns=list(measures.COLUMNS))
    floats = ["natural_period", "amplitude", "motion", "cross", "noise", "value"]
    return table.astype(
        {**dict.fromkeys(floats, "float64"), "replicate": "int64", "n_samples": "int64"}
    )


def _by_kernel(
    config: HubConfig,
    scheme: Any,
    records: Records,
    settled: int,
    amplitude: float | None,
    period: float,
    lanes: Lanes,
) -> Iterator[dict[str, Any]]:
    chain = scheme.kernel(records.sensors, config, records.steps)
    if amplitude is None:
        sums = superposed_sums(chain, lanes, settled)
    else:
        keep = config.measures.extremes
        sums = direct_sums(chain, lanes, amplitude, settled, keep_squared=keep)
    for index, replicate in enumerate(records.replicates):
        if np.all(np.isfinite(sums.products[..., index])):
            for measured in measures.from_sums(sums, index):
                yield measures.row(period, replicate, scheme.name, measured, amplitude)
        else:
            reason = "the estimate is not finite"
            yield measures.failed_row(period, replicate, scheme.name, reason, amplitude)


def _by_loop(
    config: HubConfig,
    scheme: Scheme,
    records: Records,
    settled: int,
    amplitude: float | None,
    period: float,
) -> Iterator[dict[str, Any]]:
    for index, replicate in enumerate(records.replicates):
        try:
            for measured in _looped(config, scheme, records, settled, amplitude, index):
                yield measures.row(period, replicate, scheme.name, measured, amplitude)
        except (Exception, SystemExit) as error:  # whatever a user's scheme does: the rest goes on
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            yield measures.failed_row(period, replicate, scheme.name, reason, amplitude)


def _looped(
    config: HubConfig,
    scheme: Scheme,
    records: Records,
    settled: int,
    amplitude: float | None,
    index: int,
) -> list[measures.Measured]:
    sensors = records.sensors
    motion, noise = records.motion[index], records.noise[index]
    observed = observe(motion, records.direction, sensors)
    truth = np.concatenate(
        [np.outer(s, records.direction) for s in (motion.position, motion.velocity)], axis=1
    )
    if amplitude is None:
        responses = [
            run_estimator(start(config, scheme, sensors), part, sensors)
            for part in (observed, noise)
        ]
        return list(measures.from_trajectories(responses[0], responses[1], truth, settled))
    whole = Measurements(
        amplitude * observed.specific_force + noise.specific_force,
        amplitude * observed.fixes + noise.fixes,
    )
    response = run_estimator(start(config, scheme, sensors), whole, sensors)
    extremes = config.measures.extremes
    return list(
        measures.from_trajectories(None, response, amplitude * truth, settled, extremes=extremes)
    )
