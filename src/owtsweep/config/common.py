"""The configuration keys that every study has, and the folder of YAML files that hold them."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

from pydantic import field_validator

from owtsweep.config.grid import Records
from owtsweep.config.section import NotNegative, Positive, Section, key
from owtsweep.errors import require

#: The configuration of a study, of a class that only the study knows.
AnyConfig = Any

#: The version of the configuration's keys, stored in every run's config.yaml.
CONFIG_VERSION = 1


class Compute(Section):
    """The configuration keys that say how to compute. No result depends on these keys."""

    backend: Literal["auto", "threading", "loky", "dask"] = key(
        "what runs the blocks; auto leaves the choice to the study", default="auto"
    )
    workers: int = key(
        "how many blocks run at once; 0: one per core (of the cluster, with dask)",
        default=0,
        ge=0,
        advice="use 0 for all cores",
    )
    scheduler: str | None = key(
        "address of the dask scheduler, tcp://host:port; only with backend dask", default=None
    )


class Config(Section):
    """The configuration keys that every study has; the subclass of a study adds further keys."""

    #: Keys and sections on which no stored number depends; a study may add keys to this set. Every
    #: other key changes the blocks that depend on it (`owtsweep.testing.check_study` tests this).
    inert: ClassVar[frozenset[str]] = frozenset(
        {"study", "experiment", "results", "name", "config_version", "compute", "over", "tune"}
    )
    #: The sections that a tuning file sets. With several tunings in one run, each tuning has these
    #: sections of its own (`owtsweep.config.tuned`). Empty for a study without tunings.
    tuned: ClassVar[tuple[str, ...]] = ()
    #: Dotted keys outside the section `grid` that are axes of the grid. As those of `grid`, they
    #: may change without making another run.
    swept: ClassVar[tuple[str, ...]] = ()
    #: Config groups that set one section each, whose options may also be files of the user's:
    #: `structure=./mine.yaml` (`owtsweep.config.option_files`).
    from_files: ClassVar[tuple[str, ...]] = ()

    study: str = key("which study it is")
    experiment: str = key("begins the name of the run folder", default="study")
    results: str = key("folder that holds the run folders", default="results")
    name: str | None = key(
        "the run folder; null makes a name from the experiment and the hash of the configuration",
        default=None,
    )
    seed: int = key("of all random streams", default=2019, ge=0, advice="use an integer >= 0")
    engine: str = key("how results are computed", default="batch")
    config_version: int = key("version of these keys", default=CONFIG_VERSION)
    over: dict[str, list[Any]] | None = key(
        "what nobody knows: `world`: names of worlds, or a key of the truth: its values; with "
        "`weights`: [...], equal ones unless given (docs/regret.md); null: nothing",
        default=None,
    )
    compute: Compute = key("how to compute; changes no result", default=Compute())

    @field_validator("results")
    @classmethod
    def _find_home(cls, value: str) -> str:
        return os.path.expanduser(value)  # as a shell: `~nobody` stays as it is

    def by_tuning(self) -> Mapping[str, Self]:
        """Return tuning -> the configuration of a run with this tuning alone.

        One tuning has the name "" and is the configuration itself. For several see `TunedConfig`.
        """
        return {"": self}

    def require_one_tuning(self) -> None:
        """Raise `InputError` if the run has several tunings."""
        names = list(self.by_tuning())
        require(
            len(names) == 1,
            f"tuning: {' and '.join(names)} are several tunings; choose, e.g. tuning={names[-1]}",
        )

    @property
    def tuning_name(self) -> str:
        """The name of the tuning, the key `tuning`; "" for a study without it."""
        return str(getattr(self, "tuning", ""))

    @property
    def records(self) -> Records | None:
        """The section `grid` if it says how many records a cell gets; else None."""
        grid = getattr(self, "grid", None)
        return grid if isinstance(grid, Records) else None

    def start_of_folder(self) -> str:
        """Return how the name of the run folder begins, before the run's hash."""
        return self.experiment

    def check(self) -> None:
        """Check conditions on several keys, and on the run's name.

        A study may add conditions on its keys alone; `Study.check` looks at what they name. Raise
        `InputError` if values do not fit together, or a value is refused.
        """
        self._check_scheduler(self.compute.backend, self.compute.scheduler)
        engine = type(self).model_fields["engine"]
        require(
            engine.annotation is not str or self.engine == engine.default,
            f"engine: {self.engine!r} is not known; the study has one engine, {engine.default}",
        )
        require(self.results.strip() != "", "results: it is empty; name a folder, e.g. results")
        require(
            self.results.isprintable(),
            f"results: {self.results!r} holds a character that cannot be printed; use another name",
        )
        require(
            self.config_version == CONFIG_VERSION,
            f"config_version: {self.config_version} is not known; this version writes and reads "
            f"{CONFIG_VERSION}",
        )
        if self.name is not None:
            require(
                re.fullmatch(r"[\w.+=,-]+", self.name) is not None and self.name not in (".", ".."),
                f"name: {self.name!r} is no plain folder name; use letters, digits, . _ - + = ,",
            )

    def _check_scheduler(self, backend: str, scheduler: str | None) -> None:
        if backend != "dask":
            require(
                scheduler is None,
                f"compute.scheduler: {scheduler!r} needs compute.backend=dask, not {backend}",
            )
            return
        require(
            scheduler is not None,
            "compute.scheduler: compute.backend=dask needs an address; give tcp://host:port",
        )
        require(
            re.fullmatch(r"(tcp|tls)://(\[[^\]]+\]|[^:/\s]+):\d+", str(scheduler)) is not None,
            f"compute.scheduler: {scheduler!r} is no address; give tcp://host:port",
        )


#: Least samples of a record that can be judged.
LEAST_SAMPLES = 100


class Record(Section):
    """The section `record` of studies whose records have samples of one rate."""

    duration: Positive = key("length", unit="s")
    rate: Positive = key("samples per second", unit="Hz")
    settling: NotNegative = key("left out at the beginning of every comparison", unit="s")

    @property
    def steps(self) -> int:
        return round(self.duration * self.rate)

    @property
    def settled(self) -> int:
        """The number of the first sample that is judged."""
        return round(self.settling * self.rate)

    def check_samples(self, most: int) -> None:
        """Raise `InputError` unless there are at most `most` samples, and 100 after settling."""
        require(
            LEAST_SAMPLES <= self.steps <= most,
            f"record.duration: {self.duration:g} s at {self.rate:g} Hz are {self.steps} samples; "
            f"give {LEAST_SAMPLES} to {most}",
        )
        require(
            self.steps - self.settled >= LEAST_SAMPLES,
            f"record.settling: {self.settling:g} s leave {max(self.steps - self.settled, 0)} "
            f"samples of a record of {self.duration:g} s; at least {LEAST_SAMPLES} must be left",
        )


#: The folder conf/studies/<name>/ holds trees of further studies; it is not a config group.
TREES = "studies"


@dataclass(frozen=True)
class Tree:
    """A folder of YAML files from which Hydra composes a configuration.

    `primary`: the name, without .yaml, of the file in `folder` with which Hydra begins. `model`:
    the configuration's model, from which error messages take the names of keys.
    """

    folder: Path
    primary: str
    model: type[Config]

    def groups(self) -> list[str]:
        """Return the sorted names of the config groups, the subfolders of `folder`."""
        folders = (path.name for path in self.folder.iterdir() if path.is_dir())
        return sorted(name for name in folders if name != TREES)

    def options(self, group: str) -> list[str]:
        """Return the sorted options of a config group: names of its files, without .yaml."""
        return sorted(path.stem for path in (self.folder / group).glob("*.yaml"))
