"""Outcomes of the runs of a multirun: one small file per run in the multirun folder.

Jobs may run in other processes or on other machines (joblib, submitit), so their outcomes are
passed in files, not in memory.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from owtsweep.io.files import write_atomically

OUTCOMES = ".outcomes"


@dataclass(frozen=True)
class JobOutcome:
    """The outcome of one run.

    Attributes
    ----------
    folder
        Name of its run folder inside the multirun folder.
    overrides
        The overrides of this run, without `results`.
    code
        The exit code that this run would have had outside a multirun.
    reason
        Why the code is not 0; one line.
    """

    folder: str
    overrides: list[str]
    code: int
    reason: str


def forget_outcomes(folder: Path) -> None:
    """Delete the outcomes of earlier multiruns in this folder."""
    shutil.rmtree(folder / OUTCOMES, ignore_errors=True)
    (folder / OUTCOMES).mkdir(parents=True)


def write_outcome(folder: Path, outcome: JobOutcome) -> None:
    """Write the outcome of a run; called in the process that ran it."""
    write_atomically(folder / OUTCOMES / f"{outcome.folder}.json", json.dumps(asdict(outcome)))


def read_outcomes(folder: Path) -> list[JobOutcome]:
    """All outcomes written since `forget_outcomes`, by folder."""
    paths = sorted((folder / OUTCOMES).glob("*.json"))
    return [JobOutcome(**json.loads(path.read_text())) for path in paths]


def describe_failures(run_folder: Path) -> str:
    """How many cases failed, according to the manifest of the run."""
    try:
        manifest: dict[str, Any] = json.loads((run_folder / "manifest.json").read_text())
        failed = int(manifest["cases"]["failed"])
    except (OSError, ValueError, KeyError, TypeError):
        return "some cases failed"
    return f"{failed} case{'s' * (failed != 1)} failed"
