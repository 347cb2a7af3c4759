"""Checks names of schemes that a user gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

from pydantic import BeforeValidator

from owtsweep.errors import InputError


def _refuse_classes(value: Any) -> Any:
    """Return `value`; raise `ValueError` if it is a list that holds more than names."""
    for item in value if isinstance(value, list) else []:
        if isinstance(item, Mapping):
            raise ValueError(
                f"{dict(item)} is no name; this study takes its own schemes only, by the names "
                "that `owtsweep list` shows; a class of your own (_target_) runs in study=hub and "
                "in `owtsweep replay`"
            )
    return value


#: The type of the key `schemes` of a study that takes no scheme of a user's.
SchemeNames = Annotated[list[str], BeforeValidator(_refuse_classes)]


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
