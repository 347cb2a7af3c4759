"""The outcome of one run of a multirun, as a small file in the multirun folder."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from owtsweep.cli.program import FAILED
from owtsweep.errors import InputError, printable
from owtsweep.io.files import write_atomically
from owtsweep.io.reading import read_json

#: The folder, inside the folder of a multirun, that holds the outcomes of its runs.
OUTCOMES = ".outcomes"
#: Most bytes of the file of an outcome.
MOST_BYTES = 10_000_000


@dataclass(frozen=True)
class JobOutcome:
    """The outcome of one run of a multirun, stored as a small file in the multirun folder.

    Runs may be computed in other processes or on other machines (joblib, submitit), so the
    outcomes are passed in files, not in memory.

    Attributes
    ----------
    folder
        Name of the run folder inside the multirun folder.
    overrides
        The overrides of this run, without the override of the key `results`.
    code
        The exit code that this run would have had outside a multirun.
    reason
        One line that says why `code` is not 0; "" if `code` is 0.
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
        return JobOutcome(file.stem, [], FAILED, str(error))
