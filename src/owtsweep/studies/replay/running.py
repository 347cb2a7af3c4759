"""Run a replay: from the command line to a run folder with estimates."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import changed, require
from owtsweep.errors import InputError, printable
from owtsweep.io.reading import require_regular
from owtsweep.studies import compose, get_study
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.loading import label_files, load_record
from owtsweep.studies.replay.seastates import read_sea_states, read_table

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.sweep.progress import Progress
    from owtsweep.sweep.run import Outcome
    from owtsweep.sweep.runs import Run

#: Bytes of the name of a replay; its folder's name has 11 more, and file systems allow 255.
LONGEST_EXPERIMENT = 244


def compose_replay(overrides: Sequence[str], config_dir: str | None = None) -> ReplayConfig:
    """Compose and check the configuration of a replay, without its files.

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
    """Compose and check the configuration of a replay of some files, without reading the files.

    Parameters
    ----------
    files
        Paths or patterns; by default the files that `replay.table` names.

    Raises
    ------
    InputError
        If the overrides are wrong, or no file exists.
    """
    config = compose_replay(overrides, config_dir)
    words, table = [*files, *config.grid.files], config.replay.table
    if not words and table is not None:
        words = list(read_table(table)["file"])
    paths = expand(words)
    require(len(paths) > 0, "FILE: name a record, a pattern, or replay.table=FILE.csv")
    # Absolute, so that the run can be read from another folder.
    grid = changed(config.grid, files=paths)
    if table is not None:
        config = changed(config, replay=changed(config.replay, table=str(Path(table).resolve())))
    experiment = config.experiment
    if len(paths) == 1 and experiment == "replay":
        stem = re.sub(r"[^\w.+,-]", "_", Path(paths[0]).name.split(".")[0])
        experiment = f"replay-{stem}".encode()[:LONGEST_EXPERIMENT].decode(errors="ignore")
    return changed(config, grid=grid, experiment=experiment)


def expand(words: Sequence[str]) -> list[str]:
    """Absolute paths of files and of all files that match patterns, in order and once each.

    Raises
    ------
    InputError
        If a file does not exist, or nothing matches a pattern.
    """
    paths: dict[str, None] = {}
    for word in words:
        path = Path(word).expanduser()
        if os.path.exists(path):
            require(not path.is_dir(), f"{word}: this is a folder; name files, e.g. {word}/*.csv")
            require_regular(path)
            matches = [path]
        else:
            pattern = any(sign in word for sign in "*?[")
            wrong = "nothing matches this pattern" if pattern else "there is no such file"
            matches = [Path(name) for name in sorted(glob.glob(str(path), recursive=True))]
            matches = [match for match in matches if match.is_file()]
            require(len(matches) > 0, f"{word}: {wrong}")
        paths.update({str(match.resolve()): None for match in matches})
    return list(paths)


def verify(config: ReplayConfig) -> list[str]:
    """Read every record once, so that a bad one is refused before anything is written.

    Returns the notes on the records, each only once. With many records, each note begins with the
    name of the file.

    Raises
    ------
    InputError
        The one-line message names the file.
    """
    read_sea_states(config)
    notes: dict[str, None] = {}
    for file in config.grid.files:
        name = f"{printable(Path(file).name)}: " if len(config.grid.files) > 1 else ""
        notes |= {f"{name}{note}": None for note in load_record(config, file).notes}
    return list(notes)


def execute(
    config: ReplayConfig,
    *,
    fresh: bool = False,
    progress: Progress | None = None,
    argv: Sequence[str] | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> Outcome:
    """Run the cases that are missing, then write the estimates (`report.write` writes the report).

    Parameters
    ----------
    say
        A function that shows the user a line: notes on the records before anything runs, and
        announcements of slow work.

    Raises
    ------
    InputError
        Before anything is written, for a bad record or configuration.
    """
    from owtsweep.studies.replay import estimates
    from owtsweep.sweep.run import sweep

    for note in verify(config):
        say(f"note: {note}")
    outcome = sweep(get_study(config.study), config, fresh=fresh, progress=progress, argv=argv)
    folders = locate_estimates(config, outcome.run.folder).values()
    for file, folder in zip(config.grid.files, folders, strict=True):
        estimates.write(config, file, folder, say)
    return outcome


def locate_estimates(config: ReplayConfig, run: Path) -> dict[str, Path]:
    """Label -> folder of a record's estimates: the run's, or records/<label> if there are many."""
    labels = list(label_files(config.grid.files))
    return {label: run if len(labels) == 1 else run / "records" / label for label in labels}


@dataclass(frozen=True)
class Replay:
    """A finished replay."""

    run: Run

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.run.folder

    def errors(self) -> pd.DataFrame:
        """Means over replicates, 95 % intervals: file, scheme, measure, window, mean, ..., n."""
        return self.run.table("errors")

    def advice(self) -> pd.DataFrame:
        """The best scheme and the runner-up, by the record itself and by the expected map."""
        return self.run.table("advice")

    def records(self) -> pd.DataFrame:
        """One row per record: duration, size, direction and fitted spectrum."""
        return self.run.table("records")

    def estimates(self, record: str | None = None) -> pd.DataFrame:
        """Columns time, scheme, x, y, vx, vy and their standard deviations (replicate 0).

        Parameters
        ----------
        record
            The record's name, a value of `records().file`; needed if there are several.

        Raises
        ------
        InputError
            If there are several records and none is named, or none has that name.
        """
        import pandas as pd

        assert isinstance(self.run.config, ReplayConfig)
        folders = locate_estimates(self.run.config, self.run.folder)
        if record is None and len(folders) == 1:
            record = next(iter(folders))
        if record not in folders:
            raise InputError(f"record: {record!r} is none of {', '.join(folders)}")
        return pd.read_parquet(folders[record] / "estimates.parquet")
