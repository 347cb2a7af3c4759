"""Writes and reads `multirun.json`: the runs of a multirun in order, and the keys that it swept."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from owtsweep.errors import InputError
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_json

RECORD = "multirun.json"
VERSION = 1
#: Most bytes of a record: enough for a hundred thousand runs.
MOST_BYTES = 100_000_000


@dataclass(frozen=True)
class PlannedRun:
    """A run of a multirun: the name of the run folder, all overrides, and swept key -> value."""

    folder: str
    overrides: list[str]
    values: dict[str, str]


@dataclass(frozen=True)
class Planned:
    """The content of multirun.json: the names of the run folders in order, and the swept keys."""

    folders: list[str]
    keys: list[str]


def write_record(folder: Path, overrides: Sequence[str], runs: Sequence[PlannedRun]) -> None:
    """Write `multirun.json` into the multirun's folder.

    `overrides` are the overrides (key=value) as the user gave them. `runs` are the planned runs in
    the order in which they are to run.
    """
    content = {
        "multirun_version": VERSION,
        "overrides": list(overrides),
        "runs": [asdict(run) for run in runs],
    }
    write_atomically(folder / RECORD, json.dumps(content, indent=2) + "\n")


def read_record(folder: Path) -> Planned | None:
    """Read `multirun.json` in a multirun's folder; return None if there is no such file.

    Raises
    ------
    InputError
        If the file cannot be read, or its content is not the record of a multirun.
    """
    path = folder / RECORD
    if not os.path.lexists(path):
        return None
    match read_json(path, MOST_BYTES):
        case {"runs": list(runs)}:
            pass
        case _:
            raise InputError(f"{path}: this is no record of a multirun (it lists no runs)")
    folders: list[str] = []
    keys: list[str] = []
    for run in runs:
        match run:
            case {"folder": str(name), "values": dict(values)} if _is_name(name):
                folders.append(name)
                keys += values
            case _:
                raise InputError(
                    f"{path}: this is no record of a multirun (run {len(folders)} has no name of a "
                    "folder beside it)"
                )
    return Planned(folders, keys)


def _is_name(text: str) -> bool:
    return Path(text).name == text and text not in ("", ".", "..")
