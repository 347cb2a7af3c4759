"""Turn plain data into a frozen configuration object, and configuration objects into plain data.

Plain data are dicts, lists and scalars. A configuration object is a pydantic model.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from owtsweep.config.common import Config
from owtsweep.config.section import Section
from owtsweep.config.wording import in_one_line
from owtsweep.errors import InputError

S = TypeVar("S", bound=Section)
C = TypeVar("C", bound=Config)


def typed(model: type[S], plain: Any) -> S:
    """Turn plain data into a frozen object of a pydantic model, a configuration or a section.

    Each key is checked by itself; conditions on several keys are not checked.

    Raises
    ------
    InputError
        If a key is unknown or missing, a type is wrong, or a value is out of bounds.
    """
    try:
        return model.model_validate(plain)
    except ValidationError as error:
        raise InputError(in_one_line(error, model)) from None


def checked(model: type[C], plain: Any) -> C:
    """Turn plain data into a frozen configuration of the class `model`, after `Config.check`.

    Raises
    ------
    InputError
        If a key is unknown or missing, a type is wrong, a value is out of bounds, or values do not
        fit together.
    """
    config = typed(model, plain)
    config.check()
    return config


def changed(section: S, **values: Any) -> S:
    """Return a copy of a section of a configuration, with the keys in `values` replaced.

    The new values are not checked.
    """
    return section.model_copy(update=values)


def as_mapping(section: Section) -> dict[str, Any]:
    """Return all keys of a configuration or of a section, as dicts, lists and scalars."""
    return section.model_dump(warnings=False)  # `changed` does not check types, so nor does this


def with_values(section: S, values: Mapping[str, Any]) -> S:
    """Return a copy of a configuration or of a section, with some keys set to new values.

    `values` maps a dotted key, e.g. "compute.workers", to its new value. Each key is checked by
    itself; conditions on several keys are not checked.

    Raises
    ------
    InputError
        If a key is unknown, a type is wrong, or a value is out of bounds.
    """
    plain = as_mapping(section)
    for key, value in values.items():
        *sections, name = key.split(".")
        inner = plain
        for part in sections:
            if not isinstance(inner.get(part), dict):
                inner[part] = {}
            inner = inner[part]
        inner[name] = value
    return typed(type(section), plain)
