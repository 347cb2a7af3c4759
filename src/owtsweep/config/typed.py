"""Plain data become frozen objects of a given model, and these plain data again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from owtsweep.config.common import Config
from owtsweep.config.section import Section, read_facts
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


def as_plain(section: Section) -> dict[str, Any]:
    """A configuration or a section with every key, as dicts, lists and scalars."""
    return section.model_dump(warnings=False)  # `changed` checks no types, so nor does this


def as_mapping(section: Section) -> dict[str, Any]:
    """The identifying part of a configuration or a section: dicts, lists and scalars.

    A key that is younger than stored runs is left out while it has its default value. So is a
    younger section whose keys all have their defaults. So hashes and block keys of stored runs do
    not change.
    """
    mapping = as_plain(section)
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, Section):
            mapping[name] = as_mapping(value)
        default = field.get_default(call_default_factory=True)
        if read_facts(field)["younger"] and (value == default or mapping[name] == {}):
            del mapping[name]
    return mapping


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
