"""Checks names of schemes that a user gives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from owtsweep.errors import InputError


def check_names(names: Sequence[str], registered: Iterable[str]) -> None:
    """Check that names are some of those registered, each once.

    Raises
    ------
    InputError
        If there is no name, an unknown name, or one name twice; the message says what would work.
    """
    known = list(registered)
    if not names:
        raise InputError(f"schemes: the list is empty; use e.g. schemes=[{','.join(known[:2])}]")
    for name in names:
        if list(names).count(name) > 1:
            raise InputError(f"schemes: {name!r} stands there twice; use each name once")
        if name not in known:
            raise InputError(f"schemes: there is no scheme {name!r}; use {', '.join(known)}")
