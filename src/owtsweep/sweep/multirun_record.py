"""Writes and reads what a multirun keeps: its runs in order, and the outcome of each.

`multirun.json` has the runs and the keys that were swept. Outcomes are small files.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from owtsweep.errors import InputError, printable
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_json

RECORD = "multirun.json"
VERSION = 1
#: Most bytes of a record: enough for a hundred thousand runs.
MOST_BYTES = 100_000_000
#: The folder, inside the folder of a multirun, that holds the outcomes of its runs.
OUTCOMES = ".outcomes"


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

    Raises InputError if the file cannot be read, or its content is not the record of a multirun.
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


@dataclass(frozen=True)
class JobOutcome:
    """The outcome of one run of a multirun, stored as a small file in the multirun folder.

    Runs may be computed in other processes or on other machines (joblib, submitit), so the
    outcomes are passed in files, not in memory.

    folder: Name of the run folder inside the multirun folder.
    overrides: the overrides of this run, without the override of the key `results`.
    code: the exit code that this run would have had outside a multirun.
    reason: one line that says why `code` is not 0; "" if `code` is 0.
    """

    folder: str
    overrides: list[str]
    code: int
    reason: str


def write_outcome(folder: Path, outcome: JobOutcome) -> None:
    """Write an outcome to its file. `folder` is the multirun folder."""
    file = folder / OUTCOMES / f"{outcome.folder}.json"
    write_atomically(file, json.dumps(asdict(outcome)))


def read_outcome(file: Path) -> JobOutcome:
    """Return the outcome that a file holds.

    If the file cannot be read or holds no outcome, return an outcome with exit code 1 and the
    fault of the file as the reason.
    """
    try:
        match read_json(file, MOST_BYTES):
            case {
                "folder": str(name),
                "overrides": list(words),
                "code": int(code),
                "reason": str(reason),
            } if name == file.stem and all(isinstance(word, str) for word in words):
                return JobOutcome(name, words, code, printable(reason))
        raise InputError(f"{file}: this is no outcome of a run")
    except InputError as error:
        return JobOutcome(file.stem, [], 1, str(error))
