"""The schemes of a study: what one is, and how entries of the key `schemes` become schemes.

An entry names one of the study's own, one of another package, or a class of the user.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from importlib import import_module
from importlib.metadata import entry_points
from operator import attrgetter
from typing import Annotated, Any, ClassVar, Generic, NamedTuple, NoReturn, Protocol, TypeVar

import numpy as np
from pydantic import BeforeValidator

from owtsweep.config import AnyConfig, Plain, Section, as_mapping
from owtsweep.errors import InputError, as_text, require
from owtsweep.figures.palette import SchemeStyle, reserve
from owtsweep.studies.registry import OURS, list_schemes
from owtsweep.sweep.source import describe_source, explain_doubt


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


#: The entry-point group of other packages' schemes: name -> "module:Class".
GROUP = "owtsweep.schemes"

#: A scheme of any study.
AnyScheme = Scheme[Any, Any, Any]


#: What the simplicity of a scheme that waits has more, for each of these steps.
LATE = 1000
WAITS = ("in real time", "late: it looks ahead", "after the end of the record")


class Listed(NamedTuple):
    """What is known of a scheme without importing it.

    sentence, look: What it is, in words, and its style; None: as a user's.
    simplicity: the number of its states, which it carries from sample to sample, plus that of its
        tuned numbers, which somebody must set; numbers that are one for several axes count once.
        Covariances, gains and models of structures do not count. Baselines and schemes without
        memory come first. A scheme with a latency has 1000 more; one that waits for the end of the
        record, 2000 more. No two of a study are equal: the less common or more demanding one of two
        equal schemes moves up to the next free number.
    """

    sentence: str
    look: SchemeStyle | None
    simplicity: int


class StoredScheme(dict[str, object], AnyScheme):
    """The stand-in for a user's scheme in a stored run: its entry, its name and its simplicity.

    A run folder may be another person's, and reading it runs no code that it names. The stand-in
    equals the scheme's entry in the key `schemes`, so that the configuration is written as it was.
    """

    #: Attributes of a scheme that a run stores for the stand-in.
    kept: ClassVar[tuple[str, ...]] = ("name", "simplicity")

    def __init__(self, entry: Mapping[str, object], described: Mapping[str, object]) -> None:
        super().__init__(entry)
        self.name = check_name(described["name"])
        self.simplicity = check_simplicity(self.name, described["simplicity"])

    def prepare(self, known: object) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        self.refuse()

    def refuse(self) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        raise InputError(
            f"schemes: {self.name} is a scheme of the stored run's author, whose code is not run; "
            "sweep with schemes=[{_target_: package.Class}] to run one of your own"
        )


def _check_entries(value: object) -> object:
    for entry in value if isinstance(value, list) else []:
        if not isinstance(entry, str) and not (isinstance(entry, Mapping) and "_target_" in entry):
            raise ValueError(
                f"{entry!r} is neither a name nor {{_target_: package.Class}} with its arguments"
            )
    return value


#: An entry of the key `schemes`: a name, or a mapping that names a user's class.
Entry = str | Mapping[str, object]
#: The type of the key `schemes`.
SchemeEntries = Annotated[list[Any], BeforeValidator(_check_entries)]


@dataclass(frozen=True)
class SchemeTable:
    """The schemes of a study.

    package: the package with the schemes' modules. Beside it stands the module `contract`, whose
        `Scheme` is the class of the study's schemes.
    listed: Name -> what is known of the scheme, in the order of tables and figures.
    shared: Module -> the schemes that stand there under their names, beside a base. Any other has a
        module of its own: KF is `SCHEME` in the module `kf`.
    stored: the class of stand-ins for users' schemes of stored runs.
    """

    study: str
    package: str
    listed: Mapping[str, Listed]
    shared: Mapping[str, Sequence[str]]
    stored: type[StoredScheme] = StoredScheme

    def __post_init__(self) -> None:
        """Reserve the styles of the schemes, so that they are the same in all figures."""
        looks = {name: listed.look for name, listed in self.listed.items()}
        reserve({name: look for name, look in looks.items() if look is not None})

    @cached_property
    def kind(self) -> type:
        """The class of the study's schemes."""
        contract = import_module(f"{self.package.rpartition('.')[0]}.contract")
        return contract.Scheme  # type: ignore[no-any-return]

    def describe(self) -> dict[str, str]:
        """Return name -> sentence of each scheme; those of other packages come last."""
        points = entry_points(group=GROUP)
        others = {point.name: f"{point.value}, of another package" for point in points}
        return {name: listed.sentence for name, listed in self.listed.items()} | others

    def describe_one(self, name: str) -> dict[str, str]:
        """Return facts in words on one of the study's schemes: its size, what it needs, its keys.

        Of a scheme of another package, which is not imported, there are none.
        """
        if name not in self.listed:
            return {}
        listed, scheme = self.listed[name], self.resolve(name)
        facts = {
            "size": f"{listed.simplicity % LATE} states and tuned numbers",
            "time": WAITS[listed.simplicity // LATE],
            "told": "the motion of a case" if scheme.knows_motion else "",
            "ignores": ", ".join(scheme.ignores),
            "keys": ", ".join(scheme.sections),
        }
        return {fact: text for fact, text in facts.items() if text}

    def list_simplicity(self) -> dict[str, int]:
        """Return name -> simplicity of each scheme of the study."""
        return {name: listed.simplicity for name, listed in self.listed.items()}

    def rank(self, config: AnyConfig) -> dict[str, int]:
        """Return name -> simplicity of all contenders of a configuration, the simplest first.

        Where a user's scheme says the same as one of the study's, the latter is first; two of a
        user stand in the order of the key `schemes`. A scheme of another package that is not
        installed here is last. Raise `InputError` as `resolve` if a user's class cannot be made;
        that of a stored run is not made.
        """
        ranks = dict(map(self._rank, self.list_entries(config)))
        order = sorted(ranks, key=lambda name: (ranks[name], name not in self.listed))
        return {name: ranks[name] for name in order}

    def _rank(self, entry: Entry) -> tuple[str, int]:
        if isinstance(entry, str) and entry not in self.listed:
            try:
                return entry, self.resolve(entry).simplicity
            except InputError:
                return entry, LEAST_SIMPLE
        if isinstance(entry, str):
            return entry, self.listed[entry].simplicity
        scheme = self.resolve(entry)
        return scheme.name, scheme.simplicity

    def resolve(self, entry: Entry) -> AnyScheme:
        """Return the scheme for which an entry of the key `schemes` stands.

        That is a name of the study's schemes, or of a scheme of another package; or a mapping
        `{_target_: package.Class, ...}`, whose other keys are the arguments of the class. Raise
        `InputError` if there is no such scheme, it cannot be made, has the name of one of the
        study's, or is of another study.
        """
        if isinstance(entry, StoredScheme):
            return entry  # its run is read, not computed
        if isinstance(entry, Mapping):
            return self._make(entry)
        if entry in self.listed:
            shared = next((m for m, names in self.shared.items() if entry in names), "")
            module = import_module(f"{self.package}.{shared or entry.lower()}")
            return getattr(module, entry if shared else "SCHEME")  # type: ignore[no-any-return]
        for point in entry_points(group=GROUP):
            if point.name == entry:
                scheme = self._make({"_target_": point.value.replace(":", ".")})
                require(
                    scheme.name == entry,
                    f"schemes: {point.value} calls itself {scheme.name!r}, its package {entry!r}",
                )
                return scheme
        raise InputError(f"schemes: {self._explain_unknown(entry)}")

    def resolve_all(self, entries: Sequence[Entry]) -> list[AnyScheme]:
        """Return the schemes of a run, in the order of the key `schemes`.

        Raise `InputError` if the list is empty, an entry stands for no scheme, or two schemes have
        one name.
        """
        if not entries:
            known = ",".join([*self.listed][:2])
            raise InputError(f"schemes: the list is empty; use e.g. schemes=[{known}]")
        _refuse_repeated(entries)  # before any code is imported
        schemes = [self.resolve(entry) for entry in entries]
        _refuse_repeated([scheme.name for scheme in schemes])
        return schemes

    def list_entries(self, config: AnyConfig) -> list[Entry]:
        """Return the entries of all schemes that a configuration runs."""
        return [*config.schemes]

    def choose(self, config: AnyConfig) -> list[AnyScheme]:
        """Return all schemes that the configuration of one tuning runs; raises as `resolve_all`."""
        return self.resolve_all(self.list_entries(config))

    def describe_content(self, config: AnyConfig, entry: Entry, scheme: AnyScheme) -> Plain:
        """Return what a scheme's rows depend on: name, tuning, and a user's entry and code.

        Raise `InputError` if the scheme is that of a stored run, whose code is not loaded.
        """
        given = {key: attrgetter(key)(config) for key in scheme.sections}
        tuning = {k: as_mapping(v) if isinstance(v, Section) else v for k, v in given.items()}
        return {"scheme": scheme.name, "tuning": tuning, **self.describe_code(entry, scheme)}

    def describe_code(self, entry: Entry, scheme: AnyScheme) -> dict[str, object]:
        """Return the entry and the source of a scheme that is not the study's; {} if it is.

        Rows depend on them. `numerics_version` tells of changes of the study's own schemes. Raise
        `InputError` if the scheme is that of a stored run, whose code is not loaded.
        """
        if isinstance(entry, str) and entry in self.listed:
            return {}
        if isinstance(scheme, StoredScheme):
            scheme.refuse()
        plain = entry if isinstance(entry, str) else {str(k): v for k, v in entry.items()}
        return {"entry": plain} | describe_source(type(scheme), scheme.version)

    def explain_recompute(self, scheme: AnyScheme) -> str:
        """Return why stored rows of a scheme must be recomputed; "" if they can be used."""
        ours = scheme.name in self.listed
        return "" if ours else explain_doubt(type(scheme), scheme.version)

    def describe_stored(self, schemes: Sequence[AnyScheme]) -> list[dict[str, object]]:
        """Return what a run stores of its schemes for `stand_in`: one mapping per scheme."""
        known = {name: {"simplicity": number} for name, number in self.list_simplicity().items()}
        return [
            {fact: getattr(scheme, fact) for fact in self.stored.kept} | known.get(scheme.name, {})
            for scheme in schemes
        ]

    def stand_in(self, entries: object, described: object) -> object:
        """Replace users' schemes in the key `schemes` of a stored run by stand-ins.

        `described` is what `describe_stored` made of these entries. What is no list is returned as
        it is. Raise `InputError` if an entry that is a mapping is not described as it must be.
        """
        if not isinstance(entries, list) or not any(isinstance(e, Mapping) for e in entries):
            return entries
        if not isinstance(described, list) or not all(map(self._describes, described)):
            described = []
        require(
            len(described) == len(entries),
            "schemes: plan.json describes other schemes than config.yaml names; run the sweep "
            "again",
        )
        return [
            self.stored(entry, facts) if isinstance(entry, Mapping) else entry
            for entry, facts in zip(entries, described, strict=True)
        ]

    def _describes(self, facts: object) -> bool:
        return isinstance(facts, Mapping) and {*facts} >= {*self.stored.kept}

    def _make(self, entry: Mapping[str, object]) -> AnyScheme:
        scheme = make_scheme(entry, self.kind, self.study)
        require(
            scheme.name not in self.listed,
            f"schemes: {entry['_target_']}: the name {scheme.name!r} is that of a scheme of study="
            f"{self.study}; give the class another name",
        )
        return scheme

    def _explain_unknown(self, name: str) -> str:
        others = [
            f"study={study}"
            for study in OURS
            if study != self.study and name in list_schemes(study)
        ]
        elsewhere = f" here (but in {' and '.join(others)})" if others else ""
        return (
            f"there is no scheme {name!r}{elsewhere}; use {', '.join(self.describe())}, or "
            "{_target_: package.Class} for one of your own"
        )


def _refuse_repeated(given: Sequence[Entry]) -> None:
    for each in given:
        if given.count(each) > 1:
            raise InputError(f"schemes: {each!r} stands there twice; use each name once")


def list_names(entries: Sequence[Entry]) -> list[str]:
    """Return the names of the schemes of the key `schemes`; a user's class is made for its name."""
    known = (e if isinstance(e, str | StoredScheme) else make_scheme(e) for e in entries)
    return [each if isinstance(each, str) else each.name for each in known]


def make_scheme(
    entry: Mapping[str, object], kind: type = Scheme, study: str = "<study>"
) -> AnyScheme:
    """Make a user's scheme, of a class that derives from `kind`, of its entry.

    The entry is `{_target_: package.Class, ...}`, whose other keys are the arguments of the class.
    Raise `InputError` if the class cannot be imported or made, is no scheme or one of another
    study, or states something wrong of itself.
    """
    target = str(entry["_target_"])
    module_name, _, class_name = target.rpartition(".")
    require(
        class_name != "" and module_name.strip(".") != "" and not module_name.startswith("."),
        f"schemes: _target_: {target!r} names no class; use {{_target_: package.Class}}",
    )
    arguments = {str(key): value for key, value in entry.items() if key != "_target_"}
    advice = "the class must be importable (see PYTHONPATH) and take the given arguments"
    with blame_code(target, advice):
        made: object = getattr(import_module(module_name), class_name)
        if not (isinstance(made, type) and issubclass(made, Scheme)):
            raise InputError(f"it is no class that derives from owtsweep.schemes.{study}.Scheme")
        require(
            issubclass(made, kind),
            f"schemes: {target} is a scheme of study={made.study}, not of study={study}",
        )
        lacking = sorted(made.__abstractmethods__)
        require(not lacking, f"it lacks the method {' and '.join(lacking)}")
        scheme: AnyScheme = made(**arguments)
        require(isinstance(scheme, made), f"it makes a {type(scheme).__name__}")
        scheme.check_declared()
    return scheme


@contextmanager
def blame_code(target: str, advice: str) -> Iterator[None]:
    """Turn every exception of a scheme's code but KeyboardInterrupt into an InputError of one line.

    It names the scheme by `target` and ends with `advice`, or with the text of an InputError.
    """
    try:
        yield
    except InputError as error:
        text = str(error)
        raise InputError(
            text if text.startswith("schemes: ") else f"schemes: {target} is no scheme: {text}"
        ) from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # it may even call sys.exit()
        raise InputError(
            f"schemes: {target} cannot be made ({as_text(error)}); {advice}"
        ) from error
