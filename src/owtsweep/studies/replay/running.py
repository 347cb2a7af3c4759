"""A replay from words on the command line to a run folder with estimates and a report."""

from __future__ import annotations

import glob
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import changed, require
from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.studies.replay.config import ReplayConfig

if TYPE_CHECKING:
    from owtsweep.sweep.progress import Progress
    from owtsweep.sweep.run import Outcome


def composed(overrides: Sequence[str], config_dir: str | None = None) -> ReplayConfig:
    """The checked configuration of a replay, whatever its files.

    Raises
    ------
    InputError
        If the overrides are wrong.
    """
    config = compose(overrides, config_dir, primary="replay")
    if not isinstance(config, ReplayConfig):
        raise InputError(f"study: {config.study!r} is none that replays records; leave it out")
    return config


def configure(
    files: Sequence[str], overrides: Sequence[str] = (), config_dir: str | None = None
) -> ReplayConfig:
    """The checked configuration of a replay; nothing has been read yet but a table of files.

    Parameters
    ----------
    files
        Paths or patterns; without any, those of `replay.table`.

    Raises
    ------
    InputError
        If the overrides are wrong, or no file is there.
    """
    config = composed(overrides, config_dir)
    words = [*files, *config.grid.files]
    if not words and config.replay.table is not None:
        from owtsweep.studies.replay.seastates import files_of

        words = files_of(config.replay.table)
    found = expand(words)
    require(len(found) > 0, "FILE: name a record, a pattern, or replay.table=FILE.csv")
    # Absolute, so that the run can be read from another folder.
    grid = changed(config.grid, files=found)
    table = config.replay.table
    if table is not None:
        config = changed(config, replay=changed(config.replay, table=str(Path(table).resolve())))
    experiment = config.experiment
    if len(found) == 1 and experiment == "replay":
        stem = re.sub(r"[^\w.+,-]", "_", Path(found[0]).name.split(".")[0])
        experiment = f"replay-{stem}"
    return changed(config, grid=grid, experiment=experiment)


def expand(words: Sequence[str]) -> list[str]:
    """Absolute paths of files, patterns replaced by what matches, in order and once each.

    Raises
    ------
    InputError
        If a file or a match is not there.
    """
    found: dict[str, None] = {}
    for word in words:
        path = Path(word).expanduser()
        if path.exists():
            require(path.is_file(), f"{word}: this is a folder; name files, e.g. {word}/*.csv")
            matches = [path]
        else:
            pattern = any(sign in word for sign in "*?[")
            wrong = "nothing matches this pattern" if pattern else "there is no such file"
            matches = [Path(name) for name in sorted(glob.glob(str(path), recursive=True))]
            matches = [match for match in matches if match.is_file()]
            require(len(matches) > 0, f"{word}: {wrong}")
        found.update({str(match.resolve()): None for match in matches})
    return list(found)


def verify(config: ReplayConfig) -> list[str]:
    """Read every record once, so that a bad one is refused before anything is written.

    Returns what readers and resampling have to say, each once; of many records with the file.

    Raises
    ------
    InputError
        One line that names the file.
    """
    from owtsweep.studies.replay.loading import load_record
    from owtsweep.studies.replay.seastates import sea_states

    sea_states(config)
    found: dict[str, None] = {}
    for file in config.grid.files:
        name = f"{Path(file).name}: " if len(config.grid.files) > 1 else ""
        found |= {f"{name}{note}": None for note in load_record(config, file).notes}
    return list(found)


def execute(
    config: ReplayConfig,
    *,
    fresh: bool = False,
    progress: Progress | None = None,
    argv: Sequence[str] | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> Outcome:
    """Run what is missing, then write the estimates; figures and report are `report.write`'s.

    Parameters
    ----------
    say
        Is told the notes of the records before anything runs, and what takes its time.

    Raises
    ------
    InputError
        Before anything is written, for a bad record or configuration.
    """
    from owtsweep.studies import get_study
    from owtsweep.studies.replay import estimates
    from owtsweep.sweep.run import sweep

    for note in verify(config):
        say(f"note: {note}")
    outcome = sweep(get_study(config.study), config, fresh=fresh, progress=progress, argv=argv)
    for label, folder in folders(config, outcome.run.folder).items():
        estimates.write(config, _file(config, label), folder, say)
    return outcome


def folders(config: ReplayConfig, run: Path) -> dict[str, Path]:
    """Label -> where a record's estimates go: the run folder, or records/<label> of many."""
    from owtsweep.studies.replay.blocks import labels

    names = list(labels(config.grid.files))
    return {name: run if len(names) == 1 else run / "records" / name for name in names}


def _file(config: ReplayConfig, label: str) -> str:
    from owtsweep.studies.replay.blocks import labels

    return labels(config.grid.files)[label]
