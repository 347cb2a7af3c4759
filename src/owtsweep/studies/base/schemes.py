"""Turns entries of the key `schemes` into schemes: a study's own, or a user's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from typing import Annotated, Any, NamedTuple, NoReturn

from pydantic import BeforeValidator

from owtsweep.errors import InputError, require
from owtsweep.figures.palette import SchemeStyle, reserve
from owtsweep.studies.base.contract import Scheme
from owtsweep.studies.base.users import check_name, instantiate
from owtsweep.studies.registry import OURS, list_schemes
from owtsweep.sweep.source import describe_source, explain_doubt

#: The entry-point group of other packages' schemes: name -> "module:Class".
GROUP = "owtsweep.schemes"


class Listed(NamedTuple):
    """What is known of a scheme without importing it.

    Attributes
    ----------
    sentence, look
        What it is, in words, and how it is drawn.
    ignores
        The axes of what schemes are told on which its estimates do not depend.
    """

    sentence: str
    look: SchemeStyle
    ignores: tuple[str, ...] = ()


class StoredScheme(dict[str, Any]):
    """The stand-in for a user's scheme in a stored run: its entry, and its name.

    A run folder may be another person's, and reading it runs no code that it names.
    """

    def __init__(self, entry: Mapping[str, Any], name: str) -> None:
        super().__init__(entry)
        self.name = name

    def prepare(self, known: object) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        raise InputError(
            f"schemes: {self.name} is a scheme of the stored run's author, whose code is not run; "
            "sweep with schemes=[{_target_: package.Class}] to run one of your own"
        )


def _check_entries(value: Any) -> Any:
    for entry in value if isinstance(value, list) else []:
        if not isinstance(entry, str) and not (isinstance(entry, Mapping) and "_target_" in entry):
            raise ValueError(
                f"{entry!r} is neither a name nor {{_target_: package.Class}} with its arguments"
            )
    return value


#: The type of the key `schemes`: names, and mappings that name a user's class.
SchemeEntries = Annotated[list[Any], BeforeValidator(_check_entries)]


@dataclass(frozen=True)
class SchemeTable:
    """The schemes of a study.

    Attributes
    ----------
    study
        The study's name.
    package
        The package with a module for each scheme: the scheme KF is `SCHEME` in its module `kf`.
    listed
        Name -> what is known of the scheme, in the order of tables and figures.
    """

    study: str
    package: str
    listed: Mapping[str, Listed]

    def __post_init__(self) -> None:
        """Reserve the looks of the schemes, so that they are the same in all figures."""
        reserve({name: listed.look for name, listed in self.listed.items()})

    def describe(self) -> dict[str, str]:
        """Return name -> sentence of each scheme; those of other packages come last."""
        others = {p.name: f"{p.value}, of another package" for p in self._find_others()}
        return {name: listed.sentence for name, listed in self.listed.items()} | others

    def resolve(self, entry: Any) -> Scheme[Any, Any, Any]:
        """Return the scheme for which an entry of the key `schemes` stands.

        Parameters
        ----------
        entry
            A name of the study's schemes, or of a scheme of another package; or a mapping
            `{_target_: package.Class, ...}`, whose other keys are the arguments of the class.

        Raises
        ------
        InputError
            If there is no such scheme, it cannot be made, lacks `name` or `prepare`, has the name
            of one of the study's, or is of another study.
        """
        if isinstance(entry, StoredScheme):
            return entry  # its run is read, not computed
        if isinstance(entry, Mapping):
            return self._check(make_scheme(entry), entry["_target_"])
        if entry in self.listed:
            module = import_module(f"{self.package}.{entry.lower()}")
            return module.SCHEME  # type: ignore[no-any-return]
        for point in self._find_others():
            if point.name == entry:
                scheme = self._check(
                    make_scheme({"_target_": point.value.replace(":", ".")}), point.value
                )
                require(
                    scheme.name == entry,
                    f"schemes: {point.value} calls itself {scheme.name!r}, its package {entry!r}",
                )
                return scheme
        raise InputError(f"schemes: {self._explain_unknown(entry)}")

    def resolve_all(self, entries: Sequence[Any]) -> list[Scheme[Any, Any, Any]]:
        """Return the schemes of a run, in the order of the key `schemes`.

        Raises
        ------
        InputError
            If the list is empty, an entry stands for no scheme, or two schemes have one name.
        """
        if not entries:
            known = ",".join([*self.listed][:2])
            raise InputError(f"schemes: the list is empty; use e.g. schemes=[{known}]")
        for entry in entries:  # before any code is imported
            if entries.count(entry) > 1:
                raise InputError(f"schemes: {entry!r} stands there twice; use each name once")
        schemes = [self.resolve(entry) for entry in entries]
        names = [scheme.name for scheme in schemes]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"schemes: {name!r} stands there twice; use each name once")
        return schemes

    def describe_code(self, entry: Any, scheme: Scheme[Any, Any, Any]) -> dict[str, Any]:
        """Return the entry and the source of a scheme that is not the study's; {} if it is.

        Rows depend on them. `numerics_version` tells of changes of the study's own schemes.
        """
        if scheme.name in self.listed:
            return {}
        plain = entry if isinstance(entry, str) else {str(k): v for k, v in entry.items()}
        return {"entry": plain} | describe_source(type(scheme))

    def explain_anew(self, scheme: Scheme[Any, Any, Any]) -> str:
        """Return why stored rows of a scheme must be computed anew; "" if they can be used."""
        return "" if scheme.name in self.listed else explain_doubt(type(scheme))

    def list_ignored(self, scheme: Scheme[Any, Any, Any]) -> Sequence[str]:
        """Return the axes on which a scheme's estimates do not depend; a user's may name some."""
        if scheme.name in self.listed:
            return self.listed[scheme.name].ignores
        return getattr(scheme, "ignores", ())

    def _check(self, scheme: Any, target: str) -> Scheme[Any, Any, Any]:
        own = scheme.name in self.listed
        require(
            not own,
            f"schemes: {target}: the name {scheme.name!r} is that of a scheme of study="
            f"{self.study}; give the class another name",
        )
        study = getattr(scheme, "study", self.study)
        require(
            study == self.study,
            f"schemes: {target} is a scheme of study={study}, not of study={self.study}",
        )
        return scheme  # type: ignore[no-any-return]

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

    @staticmethod
    def _find_others() -> list[Any]:
        return list(entry_points(group=GROUP))


def list_names(entries: Sequence[Any]) -> list[str]:
    """Return the names of the schemes of the key `schemes`; a user's class is made for its name."""
    return [
        entry
        if isinstance(entry, str)
        else entry.name
        if isinstance(entry, StoredScheme)
        else make_scheme(entry).name
        for entry in entries
    ]


def stand_in(entries: Any, names: Any) -> Any:
    """Replace users' schemes in the key `schemes` of a stored run by stand-ins that run no code.

    Parameters
    ----------
    entries
        The value of the key. If it is no list, it is returned as it is.
    names
        The names of these schemes, which were stored with the run.

    Raises
    ------
    InputError
        If there is no name for an entry that is a mapping.
    """
    if not isinstance(entries, list) or not any(isinstance(entry, Mapping) for entry in entries):
        return entries
    require(
        isinstance(names, list) and len(names) == len(entries),
        "schemes: plan.json describes other schemes than config.yaml names; run the sweep again",
    )
    for name in names:
        check_name(name)
    return [
        StoredScheme(entry, name) if isinstance(entry, Mapping) else entry
        for entry, name in zip(entries, names, strict=True)
    ]


def make_scheme(entry: Mapping[str, Any]) -> Scheme[Any, Any, Any]:
    """Make a user's scheme of its entry `{_target_: package.Class, ...}`.

    Raises
    ------
    InputError
        If the class cannot be imported or made, or lacks `name` or `prepare`.
    """
    scheme: Scheme[Any, Any, Any] = instantiate(entry, "prepare(known)", _check_made)
    return scheme


def _check_made(scheme: Any, target: str) -> None:
    name = getattr(scheme, "name", None)
    require(isinstance(name, str) and name != "", "it lacks name (a non-empty str)")
    check_name(name)
    list(getattr(scheme, "ignores", ()))
