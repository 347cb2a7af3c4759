"""The reference of all keys, made from the models: type, unit, default, bounds, meaning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from pydantic.fields import FieldInfo

from owtsweep.config.axes import is_axis
from owtsweep.config.section import bare_type, is_section, read_facts
from owtsweep.io.markdown import table

COLUMNS = ("key", "type", "unit", "default", "bounds", "meaning")
TYPES = {bool: "true or false", str: "text", int: "whole number", float: "number"}
#: pydantic's name of a bound -> its sign.
LIMITS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤", "min_length": "", "max_length": ""}
#: A default with more characters is not shown; `--cfg` prints it.
LONGEST = 72


class Row(NamedTuple):
    """The columns of the reference for one key."""

    key: str
    type: str
    unit: str
    default: str
    bounds: str
    meaning: str


def describe(model: Any, defaults: Mapping[str, Any], prefix: str = "") -> list[Row]:
    """A row for each key of a model.

    Parameters
    ----------
    defaults
        Values in a configuration without overrides; no default is shown for a key missing here.
    """
    rows = []
    for name, field in model.model_fields.items():
        kind = bare_type(field.annotation)
        value = defaults.get(name)
        section = is_section(kind)
        rows.append(
            Row(
                f"`{prefix}{name}`",
                "section" if section else _type(field),
                str(read_facts(field).get("unit", "")),
                _shown(value) if name in defaults and not section else "",
                ", ".join(dict.fromkeys(_bounds(field))),
                str(field.description or ""),
            )
        )
        if section:
            rows += describe(kind, value or {}, f"{prefix}{name}.")
    return rows


def page(chapters: Mapping[str, tuple[str, Sequence[Row]]], introduction: str) -> str:
    """A page of Markdown: per chapter its heading, a sentence and a table of keys."""
    parts = [introduction]
    for heading, (sentence, rows) in chapters.items():
        parts += [f"## {heading}", sentence, table(COLUMNS, rows)]
    return "\n\n".join(parts) + "\n"


def _type(field: FieldInfo) -> str:
    kind = bare_type(field.annotation)
    nullable = " or null" if type(None) in get_args(field.annotation) else ""
    if get_origin(kind) is Literal:
        return f"choice{nullable}"
    if get_origin(kind) is dict:
        return f"mapping{nullable}"
    if get_origin(kind) is list:
        item = TYPES.get(bare_type(get_args(kind)[0]), "")
        plural = {"text": " of texts", "": ""}.get(item, f" of {item}s")
        return f"{'axis' if is_axis(field) else 'list'}{plural}{nullable}"
    return f"{TYPES.get(kind, 'any')}{nullable}"


def _bounds(field: FieldInfo) -> Iterator[str]:
    """The bounds of a value, in words."""
    kind = bare_type(field.annotation)
    if get_origin(kind) is Literal:
        yield from (f"`{option}`" for option in get_args(kind))
    marks = [*field.metadata, *_nested(field.annotation)]
    limits = {name: getattr(m, name) for m in marks for name in LIMITS if hasattr(m, name)}
    lengths = limits.pop("min_length", None), limits.pop("max_length", None)
    if lengths[0] is not None:
        yield f"{lengths[0]} values" if lengths[0] == lengths[1] else "not empty"
    yield from (f"{LIMITS[name]} {limit}" for name, limit in limits.items())
    if not limits and any(getattr(m, "allow_inf_nan", None) is False for m in marks):
        yield "finite"


def _nested(annotation: Any) -> Iterator[Any]:
    """The bounds inside a type: of the items of a list, or of a type that also allows null."""
    for argument in get_args(annotation):
        yield from argument.metadata if isinstance(argument, FieldInfo) else _nested(argument)
    if get_origin(annotation) is Annotated:
        yield from annotation.__metadata__


def _shown(value: Any) -> str:
    """A default as a user would write it."""
    if value is None:
        text = "null"
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, list):
        text = f"[{', '.join(map(str, value))}]"
    else:
        text = str(value)
    return f"`{text}`" if 0 < len(text) <= LONGEST else "shown by `--cfg`"
