"""Make variations of a configuration: one key changed, an axis reversed, or a single case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from owtsweep.config import Config, Section, with_values
from owtsweep.config.section import bare_type
from owtsweep.errors import InputError
from owtsweep.sweep.study import Study

#: Keys that are not varied: `grid` and `schemes` only select blocks; the others have one value.
NOT_VARIED = frozenset({"grid", "schemes", "study", "config_version"})


def variations(study: Study, config: Config) -> Iterator[tuple[str, bool, Any]]:
    """Yield the configuration with one key changed, for each key in turn.

    Keys in `NOT_VARIED` are left out.

    Yields
    ------
    tuple
        Three items: the dotted key; False if the key is declared to change no number (inert), else
        True; the changed configuration, or None if the study accepts none of the values tried.
    """
    for name, field, value in _leaves(config):
        sections = {name[:end] for end, sign in enumerate(name) if sign == "."}
        if not {name, *sections} & NOT_VARIED:
            inert = bool({name, *sections} & config.inert)
            yield name, not inert, _vary(study, config, name, field, value)


def reversed_grids(config: Any) -> Iterator[tuple[str, Any]]:
    """Yield for each axis of the grid its name, and the configuration with the axis reversed."""
    for name, values in config.grid:
        if isinstance(values, list):
            yield name, with_values(config, {f"grid.{name}": values[::-1]})


def one_case(config: Any) -> Any:
    """Return the configuration of a run with a single case; the run is named "one-case".

    The case has the first value of each axis of the grid, one replicate and the first scheme.
    """
    values: dict[str, Any] = {"name": "one-case"}
    for name, item in config.grid:
        if item is not None:  # an axis that may be left out, and is
            values[f"grid.{name}"] = item[:1] if isinstance(item, list) else 1
    if hasattr(config, "schemes"):
        values["schemes"] = config.schemes[:1]
    return with_values(config, values)


def _leaves(section: Any, prefix: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield the dotted key, pydantic field and value of each key in a section and its subsections.

    `prefix` is the text before each key, e.g. "grid.". Keys whose value is a section are left out.
    """
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, Section):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", field, value


def _vary(study: Study, config: Any, name: str, field: Any, value: Any) -> Any:
    """Return the configuration with another value of the key `name`: the first that is accepted.

    Returns None if no tried value is accepted.

    Parameters
    ----------
    study, config
        The study, and the configuration, which is not changed.
    name, field, value
        Dotted key, its pydantic field and its value in `config`.
    """
    for candidate in _candidates(field.annotation, value):
        if candidate == value:
            continue
        try:
            other = with_values(config, {name: candidate})
            other.check()
            study.check(other)
            study.check_outside(other)
        except InputError:
            continue
        return other
    return None


def _candidates(annotation: Any, value: Any) -> list[Any]:
    """Return values to try for a key; an empty list if none are known for its type.

    Parameters
    ----------
    annotation
        The type annotation of the key.
    value
        The present value of the key, which may be among the values returned.
    """
    kind = bare_type(annotation)
    if get_origin(kind) is Literal:
        return list(get_args(kind))
    if value is None:
        options: dict[Any, list[Any]] = {str: ["other"], float: [1.0, 10.0], int: [1, 10]}
        return options.get(kind, [])
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int | float):
        more = [value + 1, value - 1, 2 * value, value / 2, 1.1 * value, 0.9 * value]
        return [int(item) if kind is int else item for item in more]
    if isinstance(value, str):
        return [f"{value}-other"]
    if isinstance(value, list) and value and all(isinstance(item, float) for item in value):
        return [[1.1 * item for item in value], [item + 0.1 for item in value]]
    return []
