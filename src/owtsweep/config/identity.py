"""A configuration as plain data: all keys, or only the keys that identify it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from owtsweep.config.section import Section, read_facts


def as_mapping(value: Any) -> dict[str, Any]:
    """The identifying part of a configuration, section or dataclass: dicts, lists and scalars.

    A key that is younger than stored runs is left out while it has its default value. So is a
    younger section whose keys all have their defaults. So hashes and block keys of stored runs do
    not change.
    """
    mapping: dict[str, Any] = _plain(value, every=False)
    return mapping


def as_plain(value: Any) -> dict[str, Any]:
    """A configuration or a section with every key, as dicts, lists and scalars."""
    mapping: dict[str, Any] = _plain(value, every=True)
    return mapping


def _plain(value: Any, *, every: bool) -> Any:
    if isinstance(value, Section):
        mapping = {}
        for name, field in type(value).model_fields.items():
            item = getattr(value, name)
            plain = _plain(item, every=every)
            default = field.get_default(call_default_factory=True)
            if every or not (read_facts(field).get("younger") and (item == default or plain == {})):
                mapping[name] = plain
        return mapping
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    if isinstance(value, Mapping):
        return {str(name): _plain(item, every=every) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, every=every) for item in value]
    return value
