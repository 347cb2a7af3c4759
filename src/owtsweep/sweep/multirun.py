"""Writes and reads what a multirun keeps: its runs in order, the outcome of each, and its page.

`multirun.json` has the runs and the keys that were swept. Outcomes are small files. The page says
which scheme is best in how many cells of each run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from owtsweep.errors import InputError, printable, require
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_as
from owtsweep.io.tables import read_map
from owtsweep.report.several_page import make_multirun_page
from owtsweep.results.answer import tell_counts
from owtsweep.sweep.asked import PAGE

RECORD = "multirun.json"
VERSION = 1
#: Most bytes of a record: enough for a hundred thousand runs.
MOST_BYTES = 100_000_000
#: The folder, inside the folder of a multirun, that holds the outcomes of its runs.
OUTCOMES = ".outcomes"
NO_RECORD = "this is no record of a multirun, with a list of runs in folders beside it"


@dataclass(frozen=True)
class PlannedRun:
    """A run of a multirun: the name of the run folder, swept key -> value, and all overrides."""

    folder: str
    values: dict[str, str]
    overrides: list[str] = field(default_factory=list)


@dataclass
class _Record:
    runs: list[PlannedRun]


def write_record(folder: Path, overrides: Sequence[str], runs: Sequence[PlannedRun]) -> None:
    """Write `multirun.json` into the multirun's folder.

    `overrides` are the overrides (key=value) as the user gave them. `runs` are the planned runs in
    the order in which they are to run.
    """
    listed = [asdict(run) for run in runs]
    content = {"multirun_version": VERSION, "overrides": list(overrides), "runs": listed}
    write_atomically(folder / RECORD, json.dumps(content, indent=2) + "\n")


def read_record(folder: Path) -> tuple[list[str], list[str]]:
    """Return the names of the run folders in order and the swept keys, from `multirun.json`.

    Without this file in the multirun's folder, both lists are empty.

    Raises InputError if the file cannot be read, or its content is not the record of a multirun.
    """
    path = folder / RECORD
    if not os.path.lexists(path):
        return [], []
    runs = read_as(_Record, path, MOST_BYTES, NO_RECORD).runs
    folders = [run.folder for run in runs]
    named = all(Path(name).name == name and name not in ("", ".", "..") for name in folders)
    require(named, f"{path}: {NO_RECORD}")
    return folders, [key for run in runs for key in run.values]


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
        outcome = read_as(JobOutcome, file, MOST_BYTES, "this is no outcome of a run")
        require(outcome.folder == file.stem, f"{file}: this is the outcome of another run")
    except InputError as error:
        return JobOutcome(file.stem, [], 1, str(error))
    return replace(outcome, reason=printable(outcome.reason))


def write_page(folder: Path, planned: Sequence[PlannedRun], outcomes: Sequence[JobOutcome]) -> None:
    """Write report.html of a multirun, which links to the pages of its runs, into its folder.

    Raises OSError if the file system refuses the file.
    """
    values = {run.folder: run.values for run in planned}
    keys = list(dict.fromkeys(key for run in planned for key in run.values))
    rows, links = [], []
    for outcome in outcomes:
        given = [values.get(outcome.folder, {}).get(key, "") for key in keys]
        verdicts = _tell_verdicts(folder / outcome.folder)
        rows.append([outcome.folder, *given, *verdicts, outcome.reason or "done"])
        there = (folder / outcome.folder / PAGE).is_file()
        links.append(f"{outcome.folder}/{PAGE}" if there else "")
    header = ["run", *keys, "judged by", "best", "error of the best", "outcome"]
    title = f"{len(outcomes)} runs: {printable(folder.name)}"
    write_atomically(folder / PAGE, make_multirun_page(title, header, rows, links))


def _tell_verdicts(run: Path) -> list[str]:
    """Return by what a run is judged, who is best in how many cells, and the range of the error."""
    shown = read_map(run)
    if shown is None:
        return ["", "", ""]
    parts = shown.groupby("tuning", sort=False) if "tuning" in shown else [("", shown)]
    told = [f"{tuning}: {tell_counts(cells)}".removeprefix(": ") for tuning, cells in parts]
    low, high = shown["error_best"].min(), shown["error_best"].max()
    return [str(shown["criterion"].iloc[0]), " ".join(told), f"{low:.3g} to {high:.3g}"]
