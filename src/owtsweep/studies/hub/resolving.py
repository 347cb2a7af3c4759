"""Turns entries of the keys `schemes` and `baselines` into schemes: ours, or a user's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

from owtsweep.errors import InputError
from owtsweep.studies.base.users import blame_code, check_name, instantiate
from owtsweep.studies.hub import names
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.stored_schemes import StoredScheme

#: Attributes and methods that a scheme may have besides name, linear and start.
OPTIONAL = ("under", "told", "kernel", "own_kernel", "stream", "sections")


def resolve(entry: Any) -> Scheme:
    """Return the scheme for which an entry of the key `schemes` stands.

    Parameters
    ----------
    entry
        A name in `names.ALL`; a mapping `{_target_: package.Class, ...}`, whose other keys are the
        arguments of the class; or a `StoredScheme`, which stands for a user's scheme in a stored
        run and is returned as it is.

    Raises
    ------
    InputError
        If the name is unknown, the class cannot be imported or instantiated, the scheme lacks
        `name`, `linear` or `start`, or the entry is none of these three.
    """
    if isinstance(entry, str):
        if entry not in names.ALL:
            raise InputError(
                f"schemes: there is no scheme {entry!r}; use {', '.join(names.ALL)} or "
                "{_target_: package.Class}"
            )
        module = import_module(f"owtsweep.studies.hub.schemes.{entry.lower()}")
        return module.SCHEME  # type: ignore[no-any-return]
    if isinstance(entry, StoredScheme):
        return entry
    if isinstance(entry, Mapping) and "_target_" in entry:
        return instantiate(entry, "start(sensors, tuning)", _check_made)  # type: ignore[no-any-return]
    raise InputError(
        f"schemes: {entry!r} is neither a name nor {{_target_: package.Class}} with its arguments"
    )


def resolve_all(entries: Sequence[Any], tuning: Any = None) -> list[Scheme]:
    """Return all schemes of a run, in the order of `entries` (the value of the key `schemes`).

    `tuning` is the study's configuration. If it is given, each scheme is replaced by the variant
    that the configuration asks for (see `under`).

    Raises
    ------
    InputError
        If the list is empty, an entry stands for no scheme, `under` fails, or two schemes have the
        same name.
    """
    if not entries:
        raise InputError("schemes: the list is empty; use e.g. schemes=[MKF,HME1]")
    schemes = [under(resolve(entry), tuning) for entry in entries]
    named = [scheme.name for scheme in schemes]
    for name in named:
        if named.count(name) > 1:
            raise InputError(f"schemes: {name!r} stands there twice; use each name once")
    return schemes


def scheme_names(config: Any) -> list[str]:
    """Return the names of a configuration's schemes, without baselines, as in its key `schemes`."""
    return [scheme.name for scheme in resolve_all(config.schemes)]


def under(scheme: Scheme, tuning: Any) -> Scheme:
    """Return the variant of a scheme for which a tuning (the study's configuration) asks.

    A scheme whose properties depend on the tuning has a method `under(tuning)`, which returns the
    variant. HME2, for example, is not linear if the tuning has constraints. A scheme without this
    method is returned as it is. If `tuning` is None, every scheme is returned as it is.

    Raises
    ------
    InputError
        If the method fails or returns no scheme.
    """
    if tuning is None or not hasattr(scheme, "under"):
        return scheme
    with blame_code(scheme.name, "its method `under` must return a scheme"):
        formed: Scheme = scheme.under(tuning)
        check_scheme(formed, scheme.name)
    return formed


def _check_made(scheme: Any, target: str) -> None:
    check_scheme(scheme, target)
    for name in OPTIONAL:  # a property that raises would do so in the middle of a sweep
        getattr(scheme, name, None)


def check_scheme(scheme: Any, target: str) -> None:
    """Check that a user's scheme has a valid `name`, a bool `linear` and a method `start`.

    Raises
    ------
    InputError
        If one of the three is missing, or the name cannot be shown in tables and figures. The
        message calls the scheme `target` and lists all that is missing.
    """
    lacks = []
    if not (isinstance(getattr(scheme, "name", None), str) and scheme.name):
        lacks.append("name (a non-empty str)")
    if not isinstance(getattr(scheme, "linear", None), bool):
        lacks.append("linear (True or False)")
    if not callable(getattr(scheme, "start", None)):
        lacks.append("start(sensors, tuning)")
    if lacks:
        raise InputError(f"schemes: {target} lacks {', '.join(lacks)}; see owtsweep.testing")
    check_name(scheme.name)
