"""Write docs/configuration.md: `python docs/make_configuration.py`.

The page is made from the pydantic models of all studies' configurations. It lists the type, unit,
default, bounds and meaning of each key.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from owtsweep.config import Config
from owtsweep.config.axes import is_axis
from owtsweep.config.section import bare_type, is_section, item_type, read_facts
from owtsweep.config.typed import as_mapping
from owtsweep.io.markdown import table
from owtsweep.studies.registry import OURS, compose

INTRODUCTION = """\
# Configuration

Every key of every study. Set one by `key=value` on the command line, e.g.
`sensors.gnss.delay=0.4`; the defaults are those of a run without overrides. Units are SI, angles
are in degrees. With several tunings, the defaults of `ekf` to `hme` are those of the first.

An *axis* is a list whose entries are numbers, `{log: [first, last, count]}` or
`{linear: [first, last, count]}`: `'grid.amplitude=[{log:[0.05,10,100]},20]'` (in quotes, because
of the shell) gives 100 amplitudes from 0.05 m to 10 m, each the same factor above the one before,
and 20 m. Numbers between the ends are rounded to 12 digits. `config.yaml` stores the numbers.

The magnitude of a number other than 0 lies between 1e-30 and 1e30: beyond them, squares of squares
cannot be computed with. Grids, windows and horizons that would need more than 4 GB are refused.

What nobody knows may be an axis too: `over={world: [...]}` ([regret.md](regret.md)).

This page is written by `python docs/make_configuration.py`."""

COLUMNS = ("key", "type", "unit", "default", "bounds", "meaning")
#: One row of a table of the page, about one key: the texts of the `COLUMNS`.
Row = tuple[str, ...]
TYPES: dict[Any, str] = {
    bool: "true or false", str: "text", int: "whole number", float: "number", Literal: "choice",
    dict: "mapping",
}  # fmt: skip
#: pydantic's name of a bound -> its sign.
LIMITS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤", "min_length": "", "max_length": ""}
#: A default with more characters than this is not shown; `--cfg` prints all defaults.
LONGEST = 72


def reference() -> str:
    """Return the page on all configuration keys, as Markdown.

    The keys that all studies share come first. Then come, for each built-in study, the keys that
    this study adds or changes.
    """
    seen = dict.fromkeys(_describe(Config, as_mapping(Config(study="")))[1:])
    sentence = "`study=NAME` says which; without it the study is `hub`."
    parts = [INTRODUCTION, "## Every study", sentence, table(COLUMNS, seen)]
    for name, entry in OURS.items():
        config = compose([f"study={name}"], primary=entry.primary)
        first = next(iter(config.by_tuning().values()))  # of several tunings, for its sections
        defaults = {**as_mapping(first), **as_mapping(config)}
        rows = [row for row in _describe(type(config), defaults) if row not in seen]
        seen |= dict.fromkeys(rows)
        sentence = "What it adds or changes, besides the keys above."
        parts += [f"## `{name}`", sentence, table(COLUMNS, rows)]
    return "\n\n".join(parts) + "\n"


def _describe(model: Any, defaults: Mapping[str, Any], prefix: str = "") -> list[Row]:
    """Return a row of the page's tables for each key of a model, including keys of its sections.

    Parameters
    ----------
    model
        The pydantic model of a configuration or of a section.
    defaults
        Key -> value in a configuration without overrides. The row of a key that is missing here
        shows no default.
    prefix
        The text before each key, e.g. "compute." for the keys of that section.
    """
    rows: list[Row] = []
    for name, field in model.model_fields.items():
        kind = bare_type(field.annotation)
        unit, bounds = read_facts(field)["unit"], ", ".join(dict.fromkeys(_bounds(field)))
        key, meaning = f"`{prefix}{name}`", str(field.description or "")
        if is_section(kind):
            rows.append((key, "section", unit, "", bounds, meaning))
            rows += _describe(kind, defaults.get(name) or {}, f"{prefix}{name}.")
        else:
            default = _shown(defaults[name]) if name in defaults else ""
            rows.append((key, _type(field), unit, default, bounds, meaning))
    return rows


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
    """Yield pydantic's bounds that stand inside a type, e.g. the bounds of a list's items.

    Parameters
    ----------
    annotation
        The type annotation of a field, e.g. for a list of positive floats.
    """
    for argument in get_args(annotation):
        yield from argument.metadata if isinstance(argument, FieldInfo) else _nested(argument)
    if get_origin(annotation) is Annotated:
        yield from annotation.__metadata__


def _shown(value: Any) -> str:
    """Return a default value between backticks, in the form in which a user would write the value.

    If the text is empty or longer than `LONGEST` characters, return a hint at `--cfg` instead.
    """
    if value is None:
        text = "null"
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, list):
        text = f"[{', '.join(map(str, value))}]"
    else:
        text = str(value)
    return f"`{text}`" if 0 < len(text) <= LONGEST else "shown by `--cfg`"


if __name__ == "__main__":
    Path(__file__).with_name("configuration.md").write_text(reference(), encoding="utf-8")
