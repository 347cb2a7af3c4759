"""What a scheme of a study is, and what the house gives to it and takes from it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np

from owtsweep.config import Section
from owtsweep.errors import InputError, require


class Knowledge:
    """The base class of the knowledge of a study's schemes: a frozen dataclass with `eq=False`.

    Two are equal if all their numbers are, those of arrays bit for bit. So a scheme is prepared
    once for all records with the same knowledge.
    """

    def __eq__(self, other: object) -> bool:
        return identify(self) == identify(other)

    def __hash__(self) -> int:
        return hash(identify(self))


def identify(value: object) -> Hashable:
    """Return what is equal for equal values: arrays, dataclasses, sections, tuples, scalars."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Section):
        return type(value), identify(list(vars(value).values()))
    if is_dataclass(value):
        return type(value), *(identify(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, (list, tuple)):
        return tuple(identify(item) for item in value)
    return value if isinstance(value, (bool, int, float, str)) else repr(value)


Known = TypeVar("Known", contravariant=True)
Measured = TypeVar("Measured", contravariant=True)
Estimates = TypeVar("Estimates", covariant=True)
K = TypeVar("K")
M = TypeVar("M")
E = TypeVar("E")

#: Most characters of a scheme's name: it stands in the cells and legends of figures.
LONGEST_NAME = 60
#: The simplicity of a scheme that does not say how simple it is.
LEAST_SIMPLE = 1_000_000


class Unable(Exception):
    """A scheme cannot work at a setting; the message is the reason."""


class NotFinite(Exception):
    """A scheme's estimates are not finite, or not of the declared shape; the message says where."""


class Ready(Protocol[Measured, Estimates]):
    """A scheme made ready for what it knows: gains are computed, records can be run."""

    def run(self, measured: Measured, /) -> Estimates:
        """Estimate from the measurements of a record."""


class Scheme(ABC, Generic[Known, Measured, Estimates]):
    """An estimation scheme; each study has a class of its own for its schemes to derive from.

    name: the scheme's name in tables and figures; unique within a run.
    study: the name of the study whose scheme it is.
    ignores: names of axes of the knowledge on which the scheme's estimates do not depend. One
        record serves all values of these axes.
    sections: the keys of the configuration on which the scheme's estimates depend, e.g. ("mkf",
        "hme.mhe"), besides those on which the rows of all schemes do.
    knows_motion: whether the scheme knows the motion of a case, where a study tells it.
    version: Stands for the scheme's code where that cannot be read; None: nothing does.
    simplicity: the number of its states plus that of its tuned numbers, as `Listed` counts them.
        Among schemes that are equally good, the one with the least is taken.
    """

    name: str
    study: ClassVar[str] = ""
    ignores: Sequence[str] = ()
    sections: Sequence[str] = ()
    knows_motion: bool = False
    version: str | None = None
    simplicity: int = LEAST_SIMPLE

    @abstractmethod
    def prepare(self, known: Known, /) -> Ready[Measured, Estimates]:
        """Make the scheme ready for what it knows.

        Raise `Unable` if the scheme cannot work there; the message says why.
        """

    def check_declared(self) -> None:
        """Check what a user's class states of itself, before anything runs.

        Raise `InputError` if the name cannot be shown in tables and figures, or another attribute
        is of a wrong type.
        """
        name: object = getattr(self, "name", "")
        require(isinstance(name, str) and name != "", "it lacks name (a non-empty str)")
        check_name(name)
        require(
            isinstance(self.ignores, Sequence) and not isinstance(self.ignores, str),
            f"ignores = {self.ignores!r} is no list of axes",
        )
        declared: object = self.sections
        require(
            isinstance(declared, list | tuple) and all(isinstance(each, str) for each in declared),
            f"schemes: {self.name} has sections = {declared!r}; give a tuple of keys of the "
            'configuration, e.g. ("mkf", "hme")',
        )
        require(isinstance(self.knows_motion, bool), "it lacks knows_motion (True or False)")
        check_simplicity(self.name, self.simplicity)
        str(self.version)  # a property that raises would do so in a sweep


@dataclass(frozen=True)
class Direct(Scheme[K, M, E]):
    """A scheme by its name, and by what makes it ready for what it knows."""

    name: str
    make: Callable[[K], Ready[M, E]]

    def prepare(self, known: K, /) -> Ready[M, E]:
        """Make the scheme ready for what it knows."""
        return self.make(known)


@dataclass(frozen=True)
class ByFunction(Generic[K, M, E]):
    """A scheme made ready that is a function of what it knows and of the measurements."""

    function: Callable[[K, M], E]
    known: K

    def run(self, measured: M, /) -> E:
        """Estimate from the measurements of a record."""
        return self.function(self.known, measured)


@dataclass(frozen=True)
class Part(Generic[K, M]):
    """One part of a record, e.g. one direction of motion: knowledge, and what sensors say."""

    known: K
    measured: M


def check_name(name: object) -> str:
    """Check that a scheme's name can be shown in tables, figures and a terminal; return it.

    Raise `InputError` if it is no text, is empty, has more than `LONGEST_NAME` characters, or one
    that cannot be printed.
    """
    if isinstance(name, str) and 0 < len(name) <= LONGEST_NAME and name.isprintable():
        return name
    raise InputError(
        f"schemes: the name {str(name)[:LONGEST_NAME]!r} cannot be used; give one of 1 to "
        f"{LONGEST_NAME} printable characters"
    )


def check_simplicity(name: str, simplicity: object) -> int:
    """Check what a scheme called `name` says of its simplicity; return it.

    Raise `InputError` if it is no whole number, or below zero.
    """
    if isinstance(simplicity, int) and not isinstance(simplicity, bool) and simplicity >= 0:
        return simplicity
    raise InputError(
        f"schemes: {name} has simplicity = {simplicity!r}; give a whole number, 0 or more: that of "
        "its states plus that of its tuned numbers"
    )
