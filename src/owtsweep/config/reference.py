"""Describes the keys of a configuration, for docs/configuration.md and `sweep --help study=...`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic.fields import FieldInfo

from owtsweep.config.grid import is_axis
from owtsweep.config.section import bare_type, is_section, item_type, list_marks, read_facts

TYPES: dict[Any, str] = {
    bool: "true or false", str: "text", int: "whole number", float: "number", Literal: "choice",
    dict: "mapping",
}  # fmt: skip
#: The type of a key that holds further keys.
SECTION = "section"
#: pydantic's name of a bound -> its sign.
LIMITS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤", "min_length": "", "max_length": ""}
#: A default with more characters than this is not shown; `--cfg` prints all defaults.
LONGEST = 72


class KeyFacts(NamedTuple):
    """What is known of a key, as texts.

    default: the default as a user would write it; "" without one, None if it is too long to show.
    bounds: Bounds of a value, e.g. "≥ 0", or the options of a choice.
    """

    key: str
    type: str
    unit: str
    default: str | None
    bounds: tuple[str, ...]
    meaning: str


def describe_keys(model: Any, defaults: Mapping[str, Any], prefix: str = "") -> list[KeyFacts]:
    """Describe each key of a pydantic model of a configuration, including keys of its sections.

    defaults: Key -> value in a configuration without overrides. A key that is missing here has no
        default.
    prefix: the text before each key, e.g. "compute." for the keys of that section.
    """
    found: list[KeyFacts] = []
    for name, field in model.model_fields.items():
        kind = bare_type(field.annotation)
        unit, bounds = read_facts(field)["unit"], tuple(dict.fromkeys(_bounds(field)))
        key, meaning = f"{prefix}{name}", str(field.description or "")
        if is_section(kind):
            found.append(KeyFacts(key, SECTION, unit, "", bounds, meaning))
            found += describe_keys(kind, defaults.get(name) or {}, f"{key}.")
        else:
            default = _show(defaults[name]) if name in defaults else ""
            found.append(KeyFacts(key, _type(field), unit, default, bounds, meaning))
    return found


def _type(field: FieldInfo) -> str:
    kind = bare_type(field.annotation)
    if get_origin(kind) is list:
        item = TYPES.get(item_type(kind))
        text = ("axis" if is_axis(field) else "list") + (f" of {item}s" if item else "")
    else:
        text = TYPES.get(get_origin(kind) or kind, "any")
    return text + (" or null" if type(None) in get_args(field.annotation) else "")


def _bounds(field: FieldInfo) -> Iterator[str]:
    """Yield the bounds of a field's value as texts, e.g. "≥ 0"; for a choice, yield each option."""
    kind = bare_type(field.annotation)
    if get_origin(kind) is Literal:
        yield from map(str, get_args(kind))
    marks = list_marks(field)
    limits = {name: getattr(m, name) for m in marks for name in LIMITS if hasattr(m, name)}
    lengths = limits.pop("min_length", None), limits.pop("max_length", None)
    if lengths[0] is not None:
        yield f"{lengths[0]} values" if lengths[0] == lengths[1] else "not empty"
    yield from (f"{LIMITS[name]} {limit}" for name, limit in limits.items())
    if not limits and any(getattr(m, "allow_inf_nan", None) is False for m in marks):
        yield "finite"


def _show(value: Any) -> str | None:
    """Return a default value as a user would write it; None if it is empty or too long."""
    if value is None:
        text = "null"
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, list):
        text = f"[{', '.join(map(str, value))}]"
    else:
        text = str(value)
    return text if 0 < len(text) <= LONGEST else None
