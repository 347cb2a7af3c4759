"""The Python interface: what the command line does, without the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING

from owtsweep.sweep.runs import load

if TYPE_CHECKING:
    from owtsweep.studies.replay.result import Replay
    from owtsweep.sweep.runs import Run

__all__ = ["load", "replay", "run"]


def run(overrides: Sequence[str] = ()) -> Run:
    """Run a study, or finish one, and return it.

    Parameters
    ----------
    overrides
        Hydra overrides as on the command line, e.g. `["grid.replicates=2", "tuning=matched"]`.

    Returns
    -------
    Run
        With its `config`, `cases()`, `summary()` and `best_scheme()`. Failed cases stand among
        its cases with the status "failed" and a reason.

    Raises
    ------
    InputError
        If the overrides are wrong; nothing has been written then.
    """
    from owtsweep.studies import compose, get_study
    from owtsweep.sweep.run import sweep

    config = compose(overrides)
    return sweep(get_study(config.study), config).run


def replay(files: str | PathLike[str] | Sequence[str], overrides: Sequence[str] = ()) -> Replay:
    """Run the schemes on recorded motion or recorded sensors.

    Parameters
    ----------
    files
        A path or pattern, or several; an empty list takes those of `replay.table`.
    overrides
        As on the command line, e.g. `["columns.position_x=TwHt1TPxi", "sensors.gnss.rate=5"]`.

    Returns
    -------
    Replay
        With `errors()`, `advice()`, `records()` and `estimates()` as DataFrames, and its `run`.

    Raises
    ------
    InputError
        If a file or an override is wrong; nothing has been written then.
    """
    from owtsweep.studies.replay.result import Replay
    from owtsweep.studies.replay.running import configure, execute

    words = [str(files)] if isinstance(files, str | PathLike) else [str(file) for file in files]
    return Replay(execute(configure(words, overrides)).run)
