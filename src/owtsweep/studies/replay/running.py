"""Run a replay: compose the configuration, check the records, run the schemes, write estimates."""

from __future__ import annotations

import glob
import logging
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.config import changed, get_key, require
from owtsweep.errors import InputError, as_text, printable
from owtsweep.io.files import refuse_in_one_line
from owtsweep.io.reading import require_regular
from owtsweep.results.status import FAILED
from owtsweep.studies import compose, get_study
from owtsweep.studies.hub.public import resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.files import label_files
from owtsweep.studies.replay.identification.of_record import estimate_noise
from owtsweep.studies.replay.loading import load_record, measure_sensors
from owtsweep.studies.replay.place import check_band
from owtsweep.studies.replay.seastates import read_sea_states, read_table

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.sweep.progress import Progress
    from owtsweep.sweep.run import Outcome
    from owtsweep.sweep.runs import Run

logger = logging.getLogger(__name__)

#: Bytes of the name of a replay; its folder's name has 11 more, and file systems allow 255.
LONGEST_EXPERIMENT = 244
#: An override whose value is the name of a channel or of a unit.
_TEXT = re.compile(r"((?:columns|units)\.\w+)=(.*)", re.DOTALL)
#: Values that Hydra takes as they are.
_PLAIN = re.compile(r"[\w./-]*")


def compose_replay(overrides: Sequence[str], config_dir: str | None = None) -> ReplayConfig:
    """Compose and check the configuration of a replay, whose files may be named later."""
    config = compose([quote_text(word) for word in overrides], config_dir, primary="replay")
    assert isinstance(config, ReplayConfig)  # `compose` refuses other studies
    return config


def configure(
    files: Sequence[str], overrides: Sequence[str] = (), config_dir: str | None = None
) -> ReplayConfig:
    """Compose and check the configuration of a replay of some files.

    Rates of recorded sensors that the overrides do not state are those that the files show.

    files: paths or patterns such as "*.csv"; without any, the files of the table `replay.table`.
    overrides: Hydra overrides, e.g. `["tuning=matched"]`.
    config_dir: a folder with further config groups for Hydra (`--config-dir`).
    Raises InputError if the overrides are wrong, a file does not exist, or no file is named.
    """
    # without the delay, which must be whole steps of an IMU whose rate the files may show
    told = [word for word in overrides if get_key(word) != "sensors.gnss.delay"]
    config = compose_replay(told, config_dir)
    words, table = [*files, *config.grid.files], config.replay.table
    if not words and table is not None:
        words = list(read_table(table)["file"])
    paths = expand(words)
    require(
        len(paths) > 0, "FILE: name a record's file or a pattern, or give replay.table=FILE.csv"
    )
    stated = {get_key(word) for word in overrides}
    rates = {} if "sensors" in stated else measure_sensors(config, paths)
    measured = [f"{key}={rate:.12g}" for key, rate in rates.items() if key not in stated]
    if [*overrides, *measured] != told:
        config = compose_replay([*overrides, *measured], config_dir)
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
    """Return the absolute paths of files and of files that match patterns; each path only once."""
    paths: dict[str, None] = {}
    for word in words:
        require(word.strip() != "", "FILE: the name is empty; name a record's file or a pattern")
        path = Path(os.path.expanduser(word))
        if os.path.exists(path):
            require(
                not path.is_dir(),
                f'{word}: this is a folder; name files in it, e.g. "{Path(word) / "*.csv"}"',
            )
            require_regular(path)
            matches = [path]
        else:
            matches = [Path(name) for name in sorted(glob.glob(str(path), recursive=True))]
            matches = [match for match in matches if match.is_file()]
            require(len(matches) > 0, _tell_missing(word, path))
        paths.update({str(match.resolve()): None for match in matches})
    return list(paths)


def quote_text(word: str) -> str:
    """Quote the name of a channel or unit in an override that Hydra would not take as it is.

    So `columns.position_x=TwHt1TPxi [m]` works as typed. Values with quotes or `${...}` stay.
    """
    found = _TEXT.fullmatch(word)
    if found is None:
        return word
    key, value = found.groups()
    value = value.strip()
    if _PLAIN.fullmatch(value) or value[0] in "'\"" or "${" in value:
        return word
    escaped = re.sub(r"(\\*)'", r"\1\1\\'", value)
    return f"{key}='{escaped}'"


def _tell_missing(word: str, path: Path) -> str:
    if any(sign in word for sign in "*?["):
        return f"{word}: nothing matches this pattern"
    if "://" in word:
        return f"{word}: files are not read from the network; download this one first"
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except OSError:  # the folder is not there, or may not be read
        return f"{word}: there is no such file, and no folder {path.parent}"
    near = get_close_matches(path.name, names, n=1)
    hint = f"; did you mean {Path(word).parent / near[0]}?" if near else ""
    return f"{word}: there is no such file{hint}"


@dataclass(frozen=True)
class Verified:
    """What reading every record once has shown.

    notes: Sentences on the records, each once; of several records they begin with the file's name.
    refused: Path of a file that cannot be used -> the reason, one line that begins with the path.
    """

    notes: Sequence[str]
    refused: Mapping[str, str]


def verify(config: ReplayConfig) -> Verified:
    """Read every record once; tell which records cannot be used.

    Raises InputError if no record, not the table of sea states or not the band can be used.
    """
    read_sea_states(config)
    files, schemes = config.grid.files, resolve_all(config.schemes)
    notes: dict[str, None] = {}
    refused: dict[str, str] = {}
    for file in files:
        name = f"{printable(Path(file).name)}: " if len(files) > 1 else ""
        try:
            record = load_record(config, file)
            said = [*record.notes, *[record.lean] * (len(files) > 1)]  # of one: beside the advice
            said += [
                f"{scheme.name} had no time to choose a spectrum, which takes "
                f"{scheme.least_duration:g} s"
                for scheme in schemes
                if record.steps * record.step < scheme.least_duration
            ]
            notes |= {f"{name}{note}": None for note in said if note}
            if doubt := estimate_noise(config, file).disagreement:
                notes[f"{name}{doubt}"] = None
        except InputError as error:
            refused[file] = str(error)
    if len(refused) == len(files):
        first = next(iter(refused.values()))
        none = f"none of the {len(files)} records can be used; the first: "
        raise InputError(first if len(files) == 1 else none + first)
    check_band(config)  # last: what a record says of the band is plainer
    return Verified(list(notes), refused)


def execute(
    config: ReplayConfig,
    *,
    fresh: bool = False,
    progress: Progress | None = None,
    argv: Sequence[str] | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> Outcome:
    """Run the cases that are missing, then write the estimates (`report.write` writes the report).

    fresh, progress, argv: as for `owtsweep.sweep.run.sweep`.
    say: shows the user a line: notes on the records, and announcements of slow work.
    Returns what was computed, reused and failed; records that cannot be used, and estimates that
        could not be written, count as failed.
    Raises InputError if no record or not the configuration can be used; nothing is written then.
    """
    from owtsweep.studies.replay.estimating import write_estimates
    from owtsweep.sweep.rows import Setback
    from owtsweep.sweep.run import sweep

    verified = verify(config)
    for note in verified.notes:
        say(f"note: {note}")
    for reason in verified.refused.values():
        say(f"left out: {reason}")
    outcome = sweep(get_study(config.study), config, fresh=fresh, progress=progress, argv=argv)
    folders = locate_estimates(config, outcome.run.place)
    stored, _ = outcome.run.stored()
    lost = [rows.loc[rows["status"] == FAILED, ["file", "scheme"]] for rows in stored.values()]
    unwritten = []
    for file, (label, folder) in zip(config.grid.files, folders.items(), strict=True):
        if file in verified.refused:
            continue
        failed = [scheme for rows in lost for scheme in rows.loc[rows["file"] == label, "scheme"]]
        try:
            with refuse_in_one_line(folder):
                write_estimates(config, file, folder, say, failed)
        except OSError:  # too many open files: no record is at fault
            raise
        except (Exception, SystemExit) as error:  # no case is lost: all are stored
            reason = str(error) if isinstance(error, InputError) else as_text(error)
            logger.warning("failed: estimates of %s: %s", label, reason)
            unwritten.append(Setback(f"estimates of {label}", reason, 0))
    return replace(outcome, failed=[*outcome.failed, *unwritten])


def locate_estimates(config: ReplayConfig, run: Path) -> dict[str, Path]:
    """Return label of a record -> folder of its estimates; of a single record the run folder."""
    labels = list(label_files(config.grid.files))
    return {label: run if len(labels) == 1 else run / "records" / label for label in labels}


@dataclass(frozen=True)
class Replay:
    """A finished replay; `run` is the stored run.

    >>> import numpy as np, owtsweep, pandas as pd
    >>> time = np.arange(0.0, 60.0, 0.05)
    >>> record = pd.DataFrame({"time": time, "x": np.sin(1.5 * time), "y": 0.0 * time})
    >>> record.to_csv("sway.csv", index=False)
    >>> replay = owtsweep.replay("sway.csv", ["schemes=[MKF]"])
    >>> round(replay.records()["natural_period"][0])  # s
    4
    >>> sorted(replay.errors()["scheme"].unique())
    ['MKF', 'last_fix', 'last_two_fixes', 'no_estimate']
    >>> replay.advice()["recommended"].tolist()
    ['MKF', 'MKF']
    >>> replay.estimates().columns[:4].tolist()
    ['time', 'scheme', 'x', 'y']
    >>> replay.folder.name.startswith("replay-sway-")
    True

    Of several records those that cannot be used are left out, with the reason:

    >>> record[:9].to_csv("short.csv", index=False)
    >>> both = owtsweep.replay(["sway.csv", "short.csv"], ["schemes=[MKF]"])
    >>> both.refused()["file"].tolist()
    ['short']

    A record of sensors shows their noise:

    >>> noise = np.random.default_rng(1).normal(0.0, 0.03, (4, time.size))
    >>> sensed = pd.DataFrame({
    ...     "time": time, "ax": -2.25 * record["x"] + noise[0], "ay": noise[1],
    ...     "gps_x": record["x"] + noise[2], "gps_y": noise[3],
    ... })
    >>> sensed.to_csv("sensed.csv", index=False)
    >>> shown = owtsweep.replay("sensed.csv", ["schemes=[MKF]"]).noise()
    >>> gnss = shown.set_index("parameter").loc["sensors.gnss.sigma"]
    >>> bool(gnss["low"] < 0.03 < gnss["high"])  # m
    True
    """

    run: Run

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.run.folder

    def errors(self) -> pd.DataFrame:
        """Return the table of errors: means over n replicates with 95 % intervals.

        Columns file, scheme, measure, window, mean, ci_low, ci_high (NaN for n = 1), n.
        """
        return self.run.table("errors")

    def advice(self) -> pd.DataFrame:
        """Return the table of advice: by the errors on a record, and by those expected for it."""
        return self.run.table("advice")

    def noise(self) -> pd.DataFrame:
        """Return what recorded sensors show of themselves, and what was stated.

        Columns file, parameter, unit, source, stated, estimate, low, high (95 %), inside.
        """
        return self.run.table("noise")

    def records(self) -> pd.DataFrame:
        """Return the table of records: one row per record, with duration, motion and spectrum."""
        return self.run.table("records")

    def refused(self) -> pd.DataFrame:
        """Return the records of several that cannot be used: columns file (the label), reason."""
        return self.run.table("refused")

    def estimates(self, record: str | None = None) -> pd.DataFrame:
        """Return the estimates of a record in replicate 0, one row per scheme and time.

        Columns time (s), scheme, x, y (m), vx, vy (m/s), and their standard deviations x_std, ...
        `record` is its label in the column `file` of `records()`; it may be left out if there is
        one record only.
        Raises InputError if no record has this label.
        """
        import pandas as pd

        assert isinstance(self.run.config, ReplayConfig)
        folders = locate_estimates(self.run.config, self.run.place)
        if record is None and len(folders) == 1:
            record = next(iter(folders))
        if record not in folders:
            raise InputError(
                f"record: {record!r} is none of {', '.join(folders)}; name one of these"
            )
        return pd.read_parquet(folders[record] / "estimates.parquet")
