"""The Python interface: what the command line does, without the terminal."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep import studies

if TYPE_CHECKING:
    from owtsweep.studies.replay.running import Replay
    from owtsweep.sweep.runs import Run

__all__ = ["load", "replay", "run"]


def run(overrides: Sequence[str] = ()) -> Run:
    """Run a study and return the run; if a run was interrupted, compute what is missing.

    Parameters
    ----------
    overrides
        Hydra overrides as on the command line, e.g. `["grid.replicates=2", "tuning=matched"]`.

    Returns
    -------
    Run
        The run, with `config`, `cases()`, `summary()` and `best_scheme()`. The cases include those
        that failed, with the status "failed" and a reason, and those that a scheme cannot compute,
        with the status "unable".

    Raises
    ------
    InputError
        If the overrides are wrong; nothing has been written then.
    """
    from owtsweep.sweep.run import sweep

    config = studies.compose(overrides)
    return sweep(studies.get_study(config.study), config).run


def load(path: str | PathLike[str]) -> Run:
    """Open the run in a folder; nothing that the folder names is imported or executed.

    Raises
    ------
    InputError
        If the folder holds no run, or one that this version cannot read.
    """
    from owtsweep.studies.opening import open_run

    return open_run(Path(os.path.expanduser(path)))


def replay(files: str | PathLike[str] | Sequence[str], overrides: Sequence[str] = ()) -> Replay:
    """Run the schemes on recorded motion or recorded sensors.

    Parameters
    ----------
    files
        A path or pattern, or a list of them. An empty list stands for the files in the table that
        the key `replay.table` names.
    overrides
        Hydra overrides as on the command line, e.g. `["columns.position_x=TwHt1TPxi",
        "sensors.gnss.rate=5"]`.

    Returns
    -------
    Replay
        The result, with `errors()`, `advice()`, `records()` and `estimates()` as DataFrames, and
        the `run` itself.

    Raises
    ------
    InputError
        If a file or an override is wrong; nothing has been written then.
    """
    from owtsweep.studies.replay.running import Replay, configure, execute

    words = [str(files)] if isinstance(files, str | PathLike) else [str(file) for file in files]
    return Replay(execute(configure(words, overrides)).run)
