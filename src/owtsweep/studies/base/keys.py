"""The keys that the configurations of several studies have alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import BeforeValidator

from owtsweep.config import Config, Plain, Positive, Section, as_mapping, key
from owtsweep.config.common import Record
from owtsweep.config.grid import Records
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.errors import require
from owtsweep.streams import Streams, stream
from owtsweep.studies.base.schemes import SchemeEntries


class Mode(Section):
    """A resonance; each study says by its own keys how large it is."""

    period: Positive = key("natural period", unit="s")
    damping: Positive = key("damping ratio", lt=1.0)


class Tune(Section):
    """The settings of the command `tune`. No result of a run depends on them."""

    trials: int = key("trials of `tune` for each set of numbers", default=30, ge=1, le=100_000)
    seed: int = key(
        "of the search and its records; not the run's `seed`, with which `tune` judges what it "
        "found",
        default=7,
        ge=0,
        advice="use an integer >= 0",
    )
    training: int = key("records of a cell on which `tune` searches", default=4, ge=1, le=1000)
    replicates: int = key(
        "records of a cell on which `tune` judges what it found", default=8, ge=2, le=1000
    )


def key_of_vector(meaning: str, unit: str = "", **facts: Any) -> Any:
    """Declare a key that holds three numbers, along the axes x, y and z."""
    form = f"three numbers, those of x, y and z{f' in {unit}' if unit else ''}"
    return key(meaning, unit=unit, form=form, min_length=3, max_length=3, **facts)


def key_of_axes(grid: type[Section]) -> Any:
    """Declare the key `axes`, of names of axes: keys of the section `grid`."""
    names = [name for name in grid.model_fields if name not in Records.model_fields]
    return key(
        f"the two axes of the map, the horizontal one first, of {', '.join(names)}; plane=NAME "
        "sets them and their values",
        min_length=2,
        max_length=2,
        form=f"two axes, e.g. [{names[0]},{names[1]}]",
    )


G = TypeVar("G", bound=Records)
F = TypeVar("F", bound=Section)
T = TypeVar("T", bound=Section)


class ContestConfig(Config):
    """What the configurations of all contests have; each declares the other keys itself."""

    inert: ClassVar[frozenset[str]] = Config.inert | {"axes", "criterion"}

    record: Record = key("a record of motion and measurements")

    if TYPE_CHECKING:
        grid: Records
        schemes: Sequence[str | Mapping[str, object]]
        criterion: str
        tune: Tune

    def draws(self, replicate: int) -> Streams:
        """Return the random streams of the record with a number, which no condition changes."""
        return partial(stream, self.seed, self.study, (), replicate)


class Tuned(Section, Generic[F]):
    """The sections of one tuning in a run of several."""

    filters: F = key("what schemes assume, and their own numbers")


class FilteredConfig(TunedConfig, ContestConfig, Generic[G, F, T]):
    """The configuration of a study whose tunings set the section `filters`.

    Classes: G of the section `grid`, F of the section `filters`, and T = Tuned[F], which a study's
    module names itself: pickle finds classes by module and name.
    """

    inert: ClassVar[frozenset[str]] = ContestConfig.inert | {"tuning"}
    tuned: ClassVar[tuple[str, ...]] = ("filters",)

    grid: G = key("what is swept over")
    schemes: SchemeEntries = key(
        "names (`owtsweep list` says what each is), or {_target_: package.Class, ...} for a scheme "
        "of your own",
        min_length=1,
    )
    tuning: str | list[str] = key(
        "name of the file that sets the section `filters`, or a list of names, whose tunings run "
        "on the same records"
    )
    tunings: dict[str, T] = key(
        "name: the section filters of this tuning; only with several tunings", default={}
    )
    filters: F = key("what schemes assume, and their own numbers", default=ABSENT)
    tune: Tune = key("settings of the command `tune`", default=Tune())

    def list_content(self) -> Plain:
        """Return the keys on which every row depends, of one tuning: all but inert ones and grid.

        `schemes` is left out, too: a row is of one scheme; and `engine`, of which there is one.
        """
        content = as_mapping(self)
        for name in (*self.inert, "grid", "schemes", "engine"):
            section, _, last = name.rpartition(".")
            (content[section] if section else content).pop(last, None)
        return content


def only_freedoms(names: Sequence[str]) -> BeforeValidator:
    """Return a validator that refuses a mapping with other keys than degrees of freedom."""

    def check(value: object) -> object:
        unknown = sorted(set(value) - set(names)) if isinstance(value, Mapping) else []
        if unknown:
            raise ValueError(f"no degree of freedom is called {unknown[0]}; use {', '.join(names)}")
        return value

    return BeforeValidator(check)


def find_freedom(freedoms: Mapping[str, T], name: str, names: Sequence[str]) -> T:
    """Return a degree of freedom of `motion.freedoms`; raises InputError if it is missing."""
    require(name in freedoms, f"motion.freedoms: {name} is missing; give all of {', '.join(names)}")
    return freedoms[name]
