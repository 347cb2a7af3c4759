"""Planning and running a replay: one block per record and scheme, and one for the record itself."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from functools import lru_cache
from pathlib import Path
from threading import BoundedSemaphore
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.config import as_mapping
from owtsweep.errors import InputError, as_text
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.blocks import backend, scheme_content
from owtsweep.studies.hub.contract import Scheme, Sensors
from owtsweep.studies.hub.kernels.layout import WIDTH as LANES
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay import facts, measures
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimates
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measuring import listen, replicates
from owtsweep.studies.replay.memory import LONG, give_back
from owtsweep.studies.replay.record import Record
from owtsweep.sweep.study import FAILED, OK, Block

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "file", "scheme", "measure", "window", "replicate", "value", "n_samples", "status", "reason",
)  # fmt: skip
#: Steps of estimates that replicates hold at once, each of its own piece: some 50 bytes each.
STEPS_AT_ONCE = 2_000_000
#: Of long records two schemes run at once, however many workers there are: memory is bounded.
_ROOM = BoundedSemaphore(2)
#: Stands as the scheme of what belongs to the record, and of holding the last fix.
RECORD, LAST_FIX = "", "last_fix"


def labels(files: Sequence[str]) -> dict[str, str]:
    """Label -> file: file names without endings, numbered where two are alike."""
    found: dict[str, str] = {}
    for file in files:
        stem = Path(file).name.split(".")[0] or Path(file).name
        label, number = stem, 2
        while label in found:
            label, number = f"{stem}-{number}", number + 1
        found[label] = file
    return found


def digest(file: str) -> str:
    """Hash of a file's bytes, and of those that belong to it (a HAWC2 .sel has its .dat).

    Raises
    ------
    InputError
        If it cannot be read.
    """
    path = Path(file)
    try:
        parts = [path]
        if path.suffix.lower() in (".sel", ".dat"):
            parts = [p for p in (path.with_suffix(".sel"), path.with_suffix(".dat")) if p.exists()]
        states = tuple((str(p), p.stat().st_size, p.stat().st_mtime_ns) for p in parts)
        return _digest(states)
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror or error})") from error


@lru_cache(maxsize=4096)
def _digest(states: tuple[tuple[str, int, int], ...]) -> str:
    result = hashlib.blake2b(digest_size=16)
    for name, _, _ in states:
        with open(name, "rb") as stream:
            while chunk := stream.read(1 << 20):
                result.update(chunk)
    return result.hexdigest()


def plan(config: ReplayConfig) -> list[Block]:
    """The record's own block, then one per scheme, for every file."""
    shared = _shared_content(config)
    schemes = resolve_all(config.schemes, config)
    # Threads share a record that was read once; processes would each read it.
    apart = (
        config.compute.backend in ("auto", "threading") and backend(config, schemes) == "threading"
    )
    blocks = []
    for label, file in labels(config.grid.files).items():
        content = {**shared, "file": label, "digest": digest(file)}
        content["ending"] = "".join(Path(file).suffixes[-2:]).lower()
        own = [scheme_content(config, e, s) for e, s in zip(config.schemes, schemes, strict=True)]
        first = {
            **content,
            "scheme": RECORD,
            "window": config.measures.window,
            "estimator": own[facts.describer(config)],
        }
        blocks.append(Block(label, f"{label}, the record", first, 1))
        for scheme, entry in zip(schemes, own, strict=True):
            group = f"{label}, {scheme.name}" if apart else label
            blocks.append(Block(group, f"{label}, {scheme.name}", {**content, **entry}, 1))
    return blocks


def _shared_content(config: ReplayConfig) -> dict[str, Any]:
    whole = as_mapping(config)
    content = {key: whole[key] for key in ("seed", "engine", "sensors", "band", "gaps")}
    content["columns"], content["units"] = config.columns.given(), config.units.given()
    content["replay"] = {key: item for key, item in whole["replay"].items() if key != "table"}
    content["settling_time"] = config.measures.settling_time
    return content


def run(config: ReplayConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one record; it is read once."""
    sensors = sensing.sensors(config.sensors)
    files = labels(config.grid.files)
    schemes = {scheme.name: scheme for scheme in resolve_all(config.schemes, config)}
    settled = round(config.measures.settling_time / sensors.step)
    for block in blocks:
        label, name = block.content["file"], block.content["scheme"]
        record = load_record(config, files[label])
        if name == RECORD:
            describer = list(schemes.values())[facts.describer(config)]
            rows = _of_record(config, record, label, describer, sensors, settled)
        else:
            rows = _of_scheme(config, record, label, schemes[name], sensors, settled)
        give_back(record)
        yield block, _frame(rows)


def _of_record(
    config: ReplayConfig, record: Record, label: str, scheme: Scheme, sensors: Sensors, settled: int
) -> list[dict[str, Any]]:
    """The rows of the record itself, and of holding the last fix."""
    found = facts.facts(config, record, sensors, scheme, settled)
    rows = [_row(label, RECORD, 0, fact) for fact in found]
    for replicate in range(replicates(config, record)):
        fixes = listen(config, sensors, record, replicate).fixes
        held = measures.held(record, fixes, sensors, settled)
        rows += [_row(label, LAST_FIX, replicate, measured) for measured in held]
    return rows


def _of_scheme(
    config: ReplayConfig, record: Record, label: str, scheme: Scheme, sensors: Sensors, settled: int
) -> list[dict[str, Any]]:
    """A scheme's rows: all replicates, some of them side by side, or why one failed."""
    rows: list[dict[str, Any]] = []
    count = replicates(config, record)
    parts = measures.edges(settled, record.steps)
    together = side_by_side(config, scheme, int(np.max(np.diff(parts))))
    for first in range(0, count, together):
        some = range(first, min(first + together, count))
        try:
            several = [listen(config, sensors, record, replicate) for replicate in some]
            tallies = [measures.Tally(record, s.fixes, sensors, settled) for s in several]
            with _ROOM if record.steps > LONG else nullcontext():
                for piece in estimates(config, scheme, sensors, several, parts):
                    for tally, estimated in zip(tallies, piece, strict=True):
                        tally.add(estimated)
                    del piece, estimated  # before the next is made: they may be large
            for replicate, tally in zip(some, tallies, strict=True):
                rows += [_row(label, scheme.name, replicate, m) for m in tally.measures()]
        except (Exception, SystemExit) as error:  # a user's scheme: the rest goes on
            reason = as_text(error)
            return [_failed(label, scheme.name, first, reason)]
    return rows


def side_by_side(config: ReplayConfig, scheme: Scheme, longest: int) -> int:
    """How many replicates to run at once, given the longest piece that each of them holds.

    Kernels work on eight lanes whether they are used or not.
    """
    if config.engine != "batch" or not hasattr(scheme, "kernel"):
        return 1
    return max(1, min(LANES // 2, STEPS_AT_ONCE // max(longest, 1)))


def _row(file: str, scheme: str, replicate: int, found: measures.Measured) -> dict[str, Any]:
    name, window, value, count = found
    return {
        "file": file, "scheme": scheme, "measure": name, "window": window, "replicate": replicate,
        "value": value, "n_samples": count, "status": OK, "reason": "",
    }  # fmt: skip


def _failed(file: str, scheme: str, replicate: int, reason: str) -> dict[str, Any]:
    row = _row(file, scheme, replicate, ("", "", float("nan"), 0))
    return {**row, "status": FAILED, "reason": reason}


def _frame(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    import pandas as pd

    table = pd.DataFrame(rows, columns=list(COLUMNS))
    return table.astype({"value": "float64", "replicate": "int64", "n_samples": "int64"})
