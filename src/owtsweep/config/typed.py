"""Make frozen objects of a given model from plain data, and changed copies of such objects."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from owtsweep.config.common import Config
from owtsweep.config.identity import as_plain
from owtsweep.config.section import Section
from owtsweep.config.wording import in_one_line
from owtsweep.errors import InputError

S = TypeVar("S", bound=Section)
C = TypeVar("C", bound=Config)


def typed(model: type[S], plain: Any) -> S:
    """An object of the model; conditions on several keys together are not checked.

    Raises
    ------
    InputError
        For unknown keys (with the nearest known one), wrong types and values out of bounds.
    """
    try:
        return model.model_validate(plain)
    except ValidationError as error:
        raise InputError(in_one_line(error, model)) from None


def checked(model: type[C], plain: Any) -> C:
    """An object of the model, with all checks done.

    Raises
    ------
    InputError
        As `typed`, and for values that do not fit together.
    """
    config = typed(model, plain)
    config.check()
    return config


def changed(section: S, **values: Any) -> S:
    """A copy with some fields replaced; types and bounds are not checked."""
    return section.model_copy(update=values)


def with_values(section: S, values: Mapping[str, Any]) -> S:
    """A copy of a configuration (or of a section) with some dotted keys set.

    Raises
    ------
    InputError
        As `typed`.
    """
    plain = as_plain(section)
    for key, value in values.items():
        *sections, name = key.split(".")
        inner = plain
        for part in sections:
            if not isinstance(inner.get(part), dict):
                inner[part] = {}
            inner = inner[part]
        inner[name] = value
    return typed(type(section), plain)
