"""Turn plain data into frozen objects of a given model, and such objects into plain data."""

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
    """Return an object of the model; conditions on several keys together are not checked.

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
    """Return an object of the model, after all checks.

    Raises
    ------
    InputError
        For unknown keys, wrong types, values out of bounds, and values that do not fit together.
    """
    config = typed(model, plain)
    config.check()
    return config


def changed(section: S, **values: Any) -> S:
    """Return a copy of a section with some fields replaced; types and bounds are not checked."""
    return section.model_copy(update=values)


def as_plain(section: Section) -> dict[str, Any]:
    """Return all keys of a configuration or a section, as dicts, lists and scalars."""
    return section.model_dump(warnings=False)  # `changed` does not check types, so nor does this


def as_mapping(section: Section) -> dict[str, Any]:
    """Return the part of a configuration or a section from which hashes and block keys are made.

    It consists of dicts, lists and scalars. A key declared as younger than stored runs is left out
    while it has its default value. So is a younger section whose keys all have their defaults.
    Hence a new key does not change the hashes and block keys of stored runs.
    """
    mapping = as_plain(section)
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, Section):
            mapping[name] = as_mapping(value)
        elif name in mapping and isinstance(value, dict):
            sections = {key: item for key, item in value.items() if isinstance(item, Section)}
            mapping[name] |= {key: as_mapping(item) for key, item in sections.items()}
        default = field.get_default(call_default_factory=True)
        if read_facts(field)["younger"] and (value == default or mapping[name] == {}):
            mapping.pop(name, None)
    return mapping


def with_values(section: S, values: Mapping[str, Any]) -> S:
    """Return a copy of a configuration or a section, with the values of some dotted keys set.

    Raises
    ------
    InputError
        For unknown keys, wrong types and values out of bounds.
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
