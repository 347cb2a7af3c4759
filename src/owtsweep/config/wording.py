"""Turn an error of pydantic into one line: the key, what is wrong, and mostly what would work."""

from __future__ import annotations

from typing import Any, get_args

from pydantic import ValidationError

from owtsweep.config.hints import explain_unknown_key, list_keys
from owtsweep.config.section import TYPE_NAMES, fields_along, item_type, read_facts
from owtsweep.config.tunings import SECTIONS

#: First words of pydantic's names of type errors -> the type expected.
TYPES = {"bool": bool, "string": str, "int": int, "float": float}


def in_one_line(error: ValidationError, model: Any) -> str:
    """Return a one-line message about a configuration that pydantic has refused.

    If `error` reports several faults, the message is about one of them: an unknown key if there is
    one, else a missing key, else the first wrong value.

    Parameters
    ----------
    error
        The error of pydantic.
    model
        The pydantic class of the configuration, from which names, units and bounds are taken.
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
            return explain_unknown_key(key, list_keys(entry, f"{section}."))
        return explain_unknown_key(key, list_keys(model))
    if kind == "missing":
        return f"{key}: this key has no value; give it one"
    if kind == "dict_type":
        return f"{key}: {value!r} is no mapping of names"
    if kind == "model_type":
        prefix = f"{key}." if key else ""
        return f"{key}: {value!r} is one value where keys are expected; use {prefix}<key>=..."
    if kind == "list_type":
        return f"{key}: {value!r} is no list; use e.g. {key}=[{value}]"
    if kind == "value_error":
        return f"{key}: {limits['error']}"
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


def _beyond(kind: str, limits: dict[str, Any], value: Any, unit: str, advice: str) -> str:
    """Return the part of an error message about a number beyond its bound, after the key.

    For a fault of another kind, return a general text with that kind.

    Parameters
    ----------
    kind
        pydantic's name of the fault, e.g. "greater_than".
    limits
        pydantic's name of the bound -> the bound; empty if there is none.
    value
        The refused value.
    unit
        The unit of the value; "" for none.
    advice
        What to do about a negative whole number, e.g. "use 0 or more".
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
            told = f"is negative; {advice}" if whole else "must be a finite number, zero or above"
            return f"{number} {told}"
        return f"{shown} must be at least {f'{limit:g} {unit}'.strip()}"
    if kind in ("less_than", "less_than_equal"):
        return f"{value} is more than {limit}; lower it"
    return f"{value!r} cannot be taken ({kind.replace('_', ' ')})"
