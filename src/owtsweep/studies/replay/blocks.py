"""Plan and run a replay in blocks: one per record and scheme, and one on each record itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from threading import BoundedSemaphore
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.config import as_mapping
from owtsweep.errors import InputError, as_text
from owtsweep.studies.hub.public import (
    SCHEMES,
    WIDTH,
    Scheme,
    Sensors,
    backend,
    make_sensors,
    resolve_all,
)
from owtsweep.studies.replay import facts, measures
from owtsweep.studies.replay.baselines import measure_baselines, sum_motion
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.files import hash_file, label_files, may_read
from owtsweep.studies.replay.identification.of_record import Noise, estimate_noise, use_estimates
from owtsweep.studies.replay.identification.words import (
    ESTIMATED,
    NOISE,
    list_values,
    name_second_run,
)
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import (
    LONG,
    ReplayRecord,
    count_replicates,
    listen,
    release_memory,
)
from owtsweep.sweep.study import FAILED, OK, Block

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "file", "scheme", "measure", "window", "replicate", "value", "n_samples", "status", "reason",
)  # fmt: skip
Row = tuple[str, str, str, str, int, float, int, str, str]
#: Most steps of estimates, over all replicates of a scheme, in memory at once; 50 bytes each.
STEPS_AT_ONCE = 2_000_000
#: At most two schemes run on long records at once, to save memory.
_LONG_RUNS = BoundedSemaphore(2)
#: Value in the column `scheme` for facts about the record itself. The values for the errors of
#: baselines, which are in the record's block too, are `baselines.BASELINE_ROWS`.
RECORD = ""
#: Keys of the section `replay` on which no row of a scheme depends.
NOT_SHARED = ("table", "noise", "disagreement")


def plan(config: ReplayConfig) -> list[Block]:
    """Return the plan: for every file a block on the record itself, then a block per scheme."""
    shared = _collect_shared_content(config)
    schemes = resolve_all(config.schemes, config)
    # Threads share a record, so each scheme is a group. Processes would each have to read it.
    apart = (
        config.compute.backend in ("auto", "threading") and backend(config, schemes) == "threading"
    )
    pairs = zip(config.schemes, schemes, strict=True)
    contents = [SCHEMES.describe_content(config, entry, scheme) for entry, scheme in pairs]
    blocks = []
    for label, file in label_files(config.grid.files).items():
        # a file that may not be read fails with that reason when its blocks are run
        digest = hash_file(file) if may_read(file) else ""
        content = {**shared, "file": label, "digest": digest}
        content["ending"] = "".join(Path(file).suffixes[-2:]).lower()
        first = {
            **content,
            "scheme": RECORD,
            "window": config.measures.window,
            "estimator": contents[facts.choose_describer(config)],
        }
        blocks.append(Block(label, f"{label}, the record", first, 1))
        for scheme, part in zip(schemes, contents, strict=True):
            name, anew = f"{label}, {scheme.name}", SCHEMES.explain_anew(scheme)
            group = name if apart else label
            blocks.append(Block(group, name, {**content, **part}, 1, anew=anew))
        blocks += _plan_noise(config, label, file, content, apart=apart)
    return blocks


def _plan_noise(
    config: ReplayConfig, label: str, file: str, content: Mapping[str, object], *, apart: bool
) -> Iterator[Block]:
    """Yield a block on a record's noise; if the stated noise is not that, those of a second run.

    The second run has a block for the baselines, whose errors depend on the estimated delay, and
    one per scheme.
    """
    noise = Noise()
    with suppress(InputError):  # `verify` says so before anything runs
        if config.replay.noise == "estimate":
            noise = estimate_noise(config, file)
    if not noise.parameters:
        return
    first = {**content, "scheme": NOISE, "noise": "estimate"}
    yield Block(label, f"{label}, its noise", first, 1)
    if noise.agrees:
        return
    other = use_estimates(config, noise)
    shared = {**content, **_collect_shared_content(other), "noise": ESTIMATED}
    yield Block(label, f"{label}, its baselines again", {**shared, "scheme": RECORD}, 1)
    for scheme, entry in zip(resolve_all(other.schemes, other), other.schemes, strict=True):
        name, anew = f"{label}, {name_second_run(scheme.name)}", SCHEMES.explain_anew(scheme)
        second = {**shared, **SCHEMES.describe_content(other, entry, scheme)}
        yield Block(name if apart else label, name, second, 1, anew=anew)


def _collect_shared_content(config: ReplayConfig) -> dict[str, object]:
    whole = as_mapping(config)
    names = ("seed", "engine", "sensors", "band", "gaps", "columns", "units")
    content = {key: whole[key] for key in names}
    content["replay"] = {
        key: item for key, item in whole["replay"].items() if key not in NOT_SHARED
    }
    content["settling_time"] = config.measures.settling_time
    return content


def run(config: ReplayConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of the plan that share a record, which is read once; yield each with its rows."""
    import pandas as pd

    sensors = make_sensors(config.sensors)
    files = label_files(config.grid.files)
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    settled = config.measures.find_settled(sensors.step)
    for block in blocks:
        label, name = block.content["file"], block.content["scheme"]
        try:
            record = load_record(config, files[label])
            if config.replay.noise == "estimate":
                estimate_noise(config, files[label])  # refuses a force that contradicts positions
        except InputError as error:  # one bad file of many
            rows = [_make_failed_row(label, name, 0, str(error))]
        else:
            noise = block.content.get("noise")
            if noise == "estimate":
                found = list_values(estimate_noise(config, files[label]))
                rows = [_make_row(label, NOISE, 0, one) for one in found]
            elif noise == ESTIMATED:
                other = use_estimates(config, estimate_noise(config, files[label]))
                known = make_sensors(other.sensors)
                if name == RECORD:
                    rows = _measure_baselines(other, record, label, known, settled)
                else:
                    scheme = {one.name: one for one in resolve_all(other.schemes, other)}[name]
                    rows = _run_scheme(other, record, label, scheme, known, settled)
                rows = [(row[0], name_second_run(row[1]), *row[2:]) for row in rows]
            elif name == RECORD:
                found = facts.measure_record(config, record)
                rows = [_make_row(label, RECORD, 0, one) for one in found]
                rows += _measure_baselines(config, record, label, sensors, settled)
            else:
                rows = _run_scheme(config, record, label, schemes[name], sensors, settled)
            release_memory(record)
        table = pd.DataFrame(rows, columns=list(COLUMNS))
        yield block, table.astype({"value": "float64", "replicate": "int64", "n_samples": "int64"})


def _measure_baselines(
    config: ReplayConfig, record: ReplayRecord, label: str, sensors: Sensors, settled: int
) -> list[Row]:
    rows: list[Row] = []
    sums = sum_motion(record, sensors, settled)
    for replicate in range(count_replicates(config, record)):
        fixes = listen(config, sensors, record, replicate).fixes
        errors = measure_baselines(record, sums, fixes, sensors, settled)
        rows += [_make_row(label, name, replicate, error) for name, error in errors]
    return rows


def _run_scheme(
    config: ReplayConfig,
    record: ReplayRecord,
    label: str,
    scheme: Scheme,
    sensors: Sensors,
    settled: int,
) -> list[Row]:
    """Run a scheme on all replicates of a record; return one row per replicate, measure and window.

    If the scheme fails, the only row has the status "failed" and the reason. `label` is the
    record's name in the rows, `settled` the first step after the settling time.
    """
    rows: list[Row] = []
    count = count_replicates(config, record)
    edges = measures.cut_into_parts(settled, record.steps)
    at_once = choose_replicates_at_once(config, scheme, int(np.max(np.diff(edges))))
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
                rows += [_make_row(label, scheme.name, number, m) for m in tally.measures()]
        except (Exception, SystemExit) as error:  # a user's scheme may fail; the others continue
            return [_make_failed_row(label, scheme.name, first, as_text(error))]
    return rows


def choose_replicates_at_once(config: ReplayConfig, scheme: Scheme, longest: int) -> int:
    """Return the number of replicates to run at once.

    A kernel always runs `WIDTH` series at once, and a replicate has two series: x and y. The number
    is smaller if so many replicates would need too much memory: `longest` is the number of steps of
    a piece, of which each replicate has one in memory. A scheme without kernel, or with
    engine=reference, runs one replicate at a time.
    """
    if config.engine != "batch" or scheme.batched != "chain":
        return 1
    return max(1, min(WIDTH // 2, STEPS_AT_ONCE // max(longest, 1)))


def _make_row(file: str, scheme: str, replicate: int, measured: measures.Measured) -> Row:
    name, window, value, count = measured
    return (file, scheme, name, window, replicate, value, count, OK, "")


def _make_failed_row(file: str, scheme: str, replicate: int, reason: str) -> Row:
    return (file, scheme, "", "", replicate, np.nan, 0, FAILED, reason)
