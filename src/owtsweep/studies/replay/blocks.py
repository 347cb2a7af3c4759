"""Plan and run a replay in blocks: one per record and scheme, and one on each record itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from threading import BoundedSemaphore
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.errors import InputError, as_text
from owtsweep.studies.hub import public as hub
from owtsweep.studies.replay import facts, measures
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.files import hash_file, label_files, may_read
from owtsweep.studies.replay.identification.of_record import Noise, estimate_noise, use_estimates
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measures import ESTIMATED, NOISE, name_second_run
from owtsweep.studies.replay.record import LONG, ReplayRecord, count_replicates, listen
from owtsweep.sweep.study import FAILED, OK, Block

#: Most steps of estimates, over all replicates of a scheme, in memory at once; 50 bytes each.
STEPS_AT_ONCE = 2_000_000
#: At most two schemes run on long records at once, to save memory.
_LONG_RUNS = BoundedSemaphore(2)
#: Value in the column `scheme` for facts about the record itself. The values for the errors of
#: baselines, which are in the record's block too, are `measures.BASELINE_ROWS`.
RECORD = ""
#: Keys of the section `replay` on which no row of a scheme depends.
NOT_SHARED = ("table", "noise", "disagreement")


class Row(NamedTuple):
    """What a row says besides the file; the second to the fifth are those of `Tally.measures`."""

    scheme: str
    measure: str = ""
    window: str = ""
    value: float = np.nan
    n_samples: int = 0
    replicate: int = 0
    status: str = OK
    reason: str = ""


def plan(config: ReplayConfig) -> list[Block]:
    """Return the plan: for every file a block on the record itself, then a block per scheme."""
    schemes = hub.resolve_all(config.schemes, config)
    describer = facts.choose_describer(config)
    estimator = hub.SCHEMES.describe_content(config, config.schemes[describer], schemes[describer])
    # Threads share a record, so each scheme is a group. Processes would each have to read it.
    apart = (
        config.compute.backend in ("auto", "threading")
        and hub.backend(config, schemes) == "threading"
    )
    blocks = []
    for label, file in label_files(config.grid.files).items():
        # a file that may not be read fails with that reason when its blocks are run
        digest = hash_file(file) if may_read(file) else ""
        ending = "".join(Path(file).suffixes[-2:]).lower()
        of_file: dict[str, object] = {"file": label, "digest": digest, "ending": ending}
        content = {**_collect_shared_content(config), **of_file}
        whole = {"scheme": RECORD, "window": config.measures.window, "estimator": estimator}
        blocks.append(Block(label, f"{label}, the record", {**content, **whole}, 1))
        blocks += _plan_schemes(config, content, apart=apart)
        noise = Noise()
        with suppress(InputError):  # `verify` says so before anything runs
            noise = estimate_noise(config, file)
        if noise.parameters:
            first = {**content, "scheme": NOISE, "noise": "estimate"}
            blocks.append(Block(label, f"{label}, its noise", first, 1))
        if noise.parameters and not noise.agrees:
            other = use_estimates(config, noise)
            content = {**_collect_shared_content(other), **of_file, "noise": ESTIMATED}
            again = {**content, "scheme": RECORD}  # a baseline's errors depend on the delay
            blocks.append(Block(label, f"{label}, its baselines again", again, 1))
            blocks += _plan_schemes(other, content, apart=apart)
    return blocks


def _plan_schemes(
    config: ReplayConfig, content: Mapping[str, object], *, apart: bool
) -> Iterator[Block]:
    for scheme, entry in zip(hub.resolve_all(config.schemes, config), config.schemes, strict=True):
        name = name_second_run(scheme.name) if "noise" in content else scheme.name
        shown, label = f"{content['file']}, {name}", str(content["file"])
        own = {**content, **hub.SCHEMES.describe_content(config, entry, scheme)}
        reason = hub.SCHEMES.explain_recompute(scheme)
        yield Block(shown if apart else label, shown, own, 1, recompute=reason)


def _collect_shared_content(config: ReplayConfig) -> dict[str, object]:
    whole = as_mapping(config)
    names = ("seed", "engine", "sensors", "band", "gaps", "columns", "units")
    replay = {key: item for key, item in whole["replay"].items() if key not in NOT_SHARED}
    content = {key: whole[key] for key in names} | {"replay": replay}
    return content | {"settling_time": config.measures.settling_time}


def run(config: ReplayConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of the plan that share a record, which is read once; yield each with its rows."""
    files = label_files(config.grid.files)
    for block in blocks:
        label, name = block.content["file"], block.content["scheme"]
        try:
            record = load_record(config, files[label])
            noise = estimate_noise(config, files[label])  # refuses a force against positions
        except InputError as error:  # one bad file of many
            rows = [Row(name, status=FAILED, reason=str(error))]
        else:
            rows = [*_run_block(config, record, block.content, noise)]
            record.release_memory()
        table = pd.DataFrame(rows, columns=list(Row._fields))
        table.insert(0, "file", label)
        yield block, table.astype({"value": "float64", "replicate": "int64", "n_samples": "int64"})


def _run_block(
    config: ReplayConfig, record: ReplayRecord, content: Mapping[str, Any], noise: Noise
) -> Iterator[Row]:
    name, again = content["scheme"], content.get("noise") == ESTIMATED
    if again:
        config = use_estimates(config, noise)
    if name == NOISE:
        rows = [Row(NOISE, *one) for one in noise.measures()]
    elif name == RECORD:
        found = [] if again else facts.measure_record(config, record)
        rows = [*(Row(RECORD, *one) for one in found), *run_baselines(config, record)]
    else:
        scheme = {one.name: one for one in hub.resolve_all(config.schemes, config)}[name]
        rows = _run_scheme(config, record, scheme)
    for row in rows:
        yield row._replace(scheme=name_second_run(row.scheme)) if again else row


def run_baselines(config: ReplayConfig, record: ReplayRecord) -> Iterator[Row]:
    """Yield the rows of the baselines on a record; their `scheme` is that of `BASELINE_ROWS`."""
    for name, baseline in measures.BASELINE_ROWS.items():
        axes = "xy" if baseline == "HOLD" else ""
        for row in _run_scheme(config, record, hub.resolve(baseline)):
            if row.measure in (*measures.SHOWN, *axes) or row.status == FAILED:
                yield row._replace(scheme=name)


def _run_scheme(config: ReplayConfig, record: ReplayRecord, scheme: hub.Scheme) -> list[Row]:
    rows: list[Row] = []
    sensors = hub.make_sensors(config.sensors)
    count, settled = count_replicates(config, record), config.measures.find_settled(sensors.step)
    edges = measures.cut_into_parts(settled, record.steps)
    at_once = _choose_replicates_at_once(config, scheme, int(np.max(np.diff(edges))))
    for first in range(0, count, at_once):
        numbers = range(first, min(first + at_once, count))
        try:
            replicates = [listen(config, sensors, record, number) for number in numbers]
            tallies = [measures.Tally(record, s.fixes, sensors, settled) for s in replicates]
            with _LONG_RUNS if record.steps > LONG else nullcontext():
                for piece in estimate_pieces(config, scheme, sensors, replicates, edges):
                    for tally, estimated in zip(tallies, piece, strict=True):
                        tally.add(estimated)
                    del piece, estimated  # free memory for the next piece
            for number, tally in zip(numbers, tallies, strict=True):
                rows += [Row(scheme.name, *measured, number) for measured in tally.measures()]
        except (Exception, SystemExit) as error:  # a user's scheme may fail; the others continue
            return [Row(scheme.name, replicate=first, status=FAILED, reason=as_text(error))]
    return rows


def _choose_replicates_at_once(config: ReplayConfig, scheme: hub.Scheme, longest: int) -> int:
    # a kernel runs `WIDTH` series at once, two of a replicate, fewer if they need too much memory
    if config.engine != "batch" or scheme.batched != "chain":
        return 1
    return max(1, min(hub.WIDTH // 2, STEPS_AT_ONCE // max(longest, 1)))
