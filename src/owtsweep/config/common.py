"""The configuration keys that every study has."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import Any, ClassVar, Literal, Self

from pydantic import field_validator

from owtsweep.config.section import Section, key
from owtsweep.errors import require

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
    vectors: bool = key(
        "whether kernels are compiled with vectors; false: plain loops, slower, the same bits "
        "(docs/vectors.md)",
        default=True,
    )
    scheduler: str | None = key(
        "address of the dask scheduler, tcp://host:port; only with backend dask", default=None
    )


class Config(Section):
    """The configuration keys that every study has; the subclass of a study adds further keys."""

    #: Keys and sections on which no stored number depends; a study may add keys to this set. Every
    #: other key changes the blocks that depend on it (`owtsweep.testing.check_keys` tests this).
    inert: ClassVar[frozenset[str]] = frozenset(
        {"study", "experiment", "results", "name", "config_version", "compute"}
    )
    #: The sections that a tuning file sets. With several tunings in one run, each tuning has these
    #: sections of its own (`owtsweep.config.tunings`). Empty for a study without tunings.
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
    compute: Compute = key("how to compute; changes no result", default=Compute())

    @field_validator("results")
    @classmethod
    def _find_home(cls, value: str) -> str:
        return os.path.expanduser(value)  # as a shell: `~nobody` stays as it is

    def by_tuning(self) -> Mapping[str, Self]:
        """Return tuning -> the configuration of a run with this tuning alone.

        A run of one tuning has one entry, with the name "": the configuration itself. A study with
        tunings holds the sections of several in the key `tunings`, by name.
        """
        sections: Mapping[str, Section] = getattr(self, "tunings", {})
        if not sections:
            return {"": self}
        return {
            name: self.model_copy(update={"tuning": name, "tunings": {}, **vars(tuned)})
            for name, tuned in sections.items()
        }

    @classmethod
    def complete(cls, plain: dict[str, Any]) -> dict[str, Any]:
        """Return composed keys with the values that follow from other keys filled in.

        This happens before the keys are typed, so that config.yaml stores the values. This base
        class returns the keys unchanged.
        """
        return plain

    def describe_origin(self) -> str:
        """Return in a line what the run's numbers depend on: truth, tuning, seed, records per cell.

        The line is empty if the study does not say.
        """
        return ""

    def start_of_folder(self) -> str:
        """Return the text with which the name of the run folder begins, before the run's hash."""
        return self.experiment

    def describe_code(self) -> Any:
        """Return a description of the user's own code that the keys of this configuration name.

        The description is JSON data and is stored with the run, since the code itself is not
        executed when the run is read. This base class returns None, because its keys cannot name
        code.
        """
        return None

    @classmethod
    def hide_code(cls, plain: dict[str, Any], described: Any) -> dict[str, Any]:
        """Return the keys of a stored run without names of code, so that no code is executed.

        This base class returns the keys unchanged, because its keys cannot name code.

        Parameters
        ----------
        plain
            The keys of the stored run, as nested dicts, lists and scalars.
        described
            The description that `describe_code` returned when the run was made.

        Raises
        ------
        InputError
            If the description does not fit the keys.
        """
        return plain

    def check(self) -> None:
        """Check conditions on several keys, and on the run's name; a study may add further checks.

        Raises
        ------
        InputError
            If values do not fit together, or a value is refused.
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

    def check_outside(self) -> None:
        """Check what lies outside of the configuration: files, and keys of other studies.

        This happens when a configuration is composed, after `check`. It never happens when a run is
        read: a stranger's run opens no file that it names. This base class has nothing to check.

        Raises
        ------
        InputError
            If a file cannot be used, or another study refuses its keys.
        """

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
