"""Turn plain data into a frozen configuration object, and configuration objects into plain data.

Plain data are dicts, lists and scalars. A configuration object is a pydantic model. What pydantic
refuses is told in one line: the key, what is wrong, and mostly what would work.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar, get_args

from pydantic import ValidationError

from owtsweep.config.common import Config
from owtsweep.config.hints import explain_unknown_key, list_keys
from owtsweep.config.section import (
    TYPE_NAMES,
    Plain,
    Section,
    fields_along,
    is_section,
    item_type,
    read_facts,
)
from owtsweep.config.tuned import SECTIONS
from owtsweep.errors import InputError

S = TypeVar("S", bound=Section)
C = TypeVar("C", bound=Config)


def typed(model: type[S], plain: object) -> S:
    """Turn plain data into a frozen object of a model, each key checked by itself.

    Raise `InputError` if a key is unknown or missing, a type is wrong, or a value is out of bounds.
    """
    try:
        return model.model_validate(plain)
    except ValidationError as error:
        raise InputError(in_one_line(error, model)) from None


def checked(model: type[C], plain: object) -> C:
    """Turn plain data into a frozen configuration of the class `model`, after `Config.check`.

    Raise `InputError` as `typed` does, and if values do not fit together.
    """
    config = typed(model, plain)
    config.check()
    return config


def changed(section: S, **values: object) -> S:
    """Return a copy of a section with the keys in `values` replaced, unchecked."""
    return section.model_copy(update=values)


def as_mapping(section: Section) -> Plain:
    """Return all keys of a configuration or of a section, as dicts, lists and scalars."""
    return section.model_dump(warnings=False)  # `changed` does not check types, so nor does this


def value_at(plain: object, key: str) -> object:
    """Return the value of a dotted key in plain data; None if it has no such key."""
    for part in key.split("."):
        plain = plain.get(part) if isinstance(plain, dict) else None
    return plain


def with_values(section: S, values: Mapping[str, object]) -> S:
    """Return a copy of a section with some keys set, e.g. "compute.workers", each checked.

    Raise `InputError` if a key is unknown, a type is wrong, or a value is out of bounds.
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


#: First words of pydantic's names of type errors -> the type expected.
TYPES = {"bool": bool, "string": str, "int": int, "float": float}


def in_one_line(error: ValidationError, model: type[Section]) -> str:
    """Return a one-line message about a configuration that pydantic has refused.

    Of several faults it names one: an unknown key if there is one, else a missing key, else the
    first wrong value.
    """
    order = {"extra_forbidden": 0, "missing": 1}
    first = min(error.errors(include_url=False), key=lambda e: order.get(e["type"], 2))
    kind, value, limits, path = first["type"], first["input"], first.get("ctx", {}), first["loc"]
    if path[:1] == (SECTIONS,):
        path = path[2:]  # what belongs to one of several tunings is named as in a run of one
    steps = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    key = "".join(steps).removeprefix(".")
    if kind == "extra_forbidden":
        section, _, _ = key.rpartition(".")
        if section.endswith("]"):  # an entry of a list of sections
            entry = item_type(fields_along(model, path[:-1])[-1].annotation)
            keys = list_keys(entry, f"{section}.") if is_section(entry) else []
            return explain_unknown_key(key, keys)
        return explain_unknown_key(key, list_keys(model))
    prefix = f"{key}." if key else ""
    plain = {
        "missing": "this key has no value; give it one",
        "dict_type": f"{value!r} is no mapping of names",
        "model_type": f"{value!r} is one value where keys are expected; use {prefix}<key>=...",
        "list_type": f"{value!r} is no list; use e.g. {key}=[{value}]",
        "value_error": str(limits.get("error")),
    }
    if kind in plain:
        return f"{key}: {plain[kind]}"
    field = fields_along(model, path)[-1]
    facts = read_facts(field)
    unit, form = facts["unit"], facts["form"]
    if kind == "literal_error":
        options = get_args(item_type(field.annotation))
        return f"{key}: {value!r} is none of {', '.join(map(str, options))}"
    if kind in ("too_short", "too_long"):
        if form:
            return f"{key}: {value} must be {form}"
        return f"{key}: the list is empty; give at least one value" + (f", in {unit}" * bool(unit))
    if kind.split("_")[0] in TYPES:
        return f"{key}: {value!r} is not {TYPE_NAMES[TYPES[kind.split('_')[0]]]}"
    fault = _beyond(kind, limits, value, unit, facts["advice"] or "use 0 or more")
    return f"{key}: {fault}" + (f"; use {form}" if form else "")


def _beyond(kind: str, limits: Mapping[str, object], value: object, unit: str, advice: str) -> str:
    """Return the part of an error message about a number beyond its bound, after the key.

    For a fault of another kind, return a general text. `kind` is pydantic's name of the fault, e.g.
    "greater_than"; `limits` maps pydantic's name of a bound to the bound; `advice` says what to do
    about a negative whole number, e.g. "use 0 or more".
    """
    shown = f"{value:g}" if isinstance(value, float) else str(value)  # it may be a text, or huge
    number = f"{shown} {unit}".strip()
    if kind == "finite_number":
        return f"{number} must be a finite number"
    limit = next(iter(limits.values()), None)
    if kind == "greater_than":
        above = "zero" if limit == 0 else f"{limit:g}"
        return f"{number} must be a finite number above {above}"
    if kind == "greater_than_equal":
        if limit == 0:
            whole = isinstance(limit, int)
            text = f"is negative; {advice}" if whole else "must be a finite number, zero or above"
            return f"{number} {text}"
        return f"{shown} must be at least {f'{limit:g} {unit}'.strip()}"
    if kind == "less_than":
        return f"{number} must be below {f'{limit:g} {unit}'.strip()}"
    if kind == "less_than_equal":
        return f"{value} is more than {limit}; lower it"
    return f"{value!r} cannot be taken ({kind.replace('_', ' ')})"
