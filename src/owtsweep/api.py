"""The Python interface: functions that do what the command line does, without a terminal."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep import studies
from owtsweep.errors import require
from owtsweep.studies.estimating import estimate

if TYPE_CHECKING:
    from owtsweep.studies.replay.running import Replay
    from owtsweep.sweep.runs import Run

__all__ = ["estimate", "load", "replay", "run"]


def run(overrides: Sequence[str] = ()) -> Run:
    """Run a study and return the run.

    If a run of the same configuration was interrupted, only what is missing is computed.
    `overrides` are Hydra's as on the command line, e.g. `["grid.replicates=2", "tuning=matched"]`.

    Returns: Its methods `cases()`, `summary()` and `best_scheme()` return tables; `config` is its
        configuration. In `cases()`, the status is "failed" where a scheme failed, and "unable"
        where it cannot work under the conditions; the column `reason` says why.
    Raises InputError if an override is wrong. Nothing has been written in this case.
    """
    from owtsweep.sweep.run import sweep

    config = studies.compose(overrides)
    return sweep(studies.get_study(config.study), config).run


def load(path: str | PathLike[str]) -> Run:
    """Open the run in a folder, without importing or executing any code that the folder names.

    Raises InputError if the folder holds no run, or a run that this version of owtsweep cannot
        read.
    """
    from owtsweep.studies.opening import open_run

    require(isinstance(path, str | PathLike), f"path: {path!r} is no path; give that of a folder")
    return open_run(Path(os.path.expanduser(path)))


def replay(files: str | PathLike[str] | Sequence[str], overrides: Sequence[str] = ()) -> Replay:
    """Run the schemes on recorded motion or recorded sensors.

    files: a path, a pattern such as "data/*.csv", or a list of paths and patterns. An empty list
        stands for the files of the table that the override `replay.table=FILE.csv` names.
    overrides: Hydra overrides as on the command line, e.g. `["columns.position_x=TwHt1TPxi",
        "sensors.gnss.rate=5"]`.
    Returns: Its methods `errors()`, `advice()`, `records()` and `estimates()` return DataFrames;
        its attribute `run` is the run. Of several records, those that cannot be used are left out;
        `refused()` lists them with the reason.
    Raises InputError if no file can be used, a file does not exist, or an override is wrong.
        Nothing has been written in this case.
    """
    from owtsweep.studies.registry import require_texts
    from owtsweep.studies.replay.running import Replay, configure, execute

    named = [files] if isinstance(files, str | PathLike) else files
    require(
        isinstance(named, Sequence) and all(isinstance(file, str | PathLike) for file in named),
        f"files: {files!r} is no path; give one, or a list of paths",
    )
    require_texts(overrides)
    words = [str(file) for file in named]
    return Replay(execute(configure(words, overrides)).run)
