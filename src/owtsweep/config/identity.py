"""A configuration as plain data: all of it, or what identifies it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from owtsweep.config.section import Section, read_facts


def as_mapping(value: Any) -> dict[str, Any]:
    """What identifies a configuration, a section or a dataclass: dicts, lists and scalars.

    A key that is younger than stored runs is left out while it stands at its default, and so is a
    younger section all of whose keys do: hashes and block keys of stored runs stay as they are.
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
