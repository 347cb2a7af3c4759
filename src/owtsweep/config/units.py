"""Writes a configuration as YAML with the unit of each number in a comment, for readers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args, get_origin

from owtsweep.config.common import Config
from owtsweep.config.section import bare_type, is_section, read_facts
from owtsweep.config.stored import dump


def dump_with_units(config: Config) -> str:
    """Return a configuration as YAML text, with comments such as `# m/s^2`.

    The comment stands behind the key, on the line of the key. A key whose numbers have no unit has
    no comment. The text holds the data of `dump`, and can be read back.
    """
    import yaml

    text = dump(config)
    lines = text.splitlines()
    for line, unit in _find_units(yaml.compose(text, Loader=yaml.SafeLoader), type(config)):
        lines[line] += f"  # {unit}"
    return "\n".join([*lines, ""])


def _find_units(node: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the number of the line and the unit, for each key of a YAML node that has a unit.

    Parameters
    ----------
    node
        The node of a section, as `yaml.compose` returns it.
    model
        The class of the section.
    """
    for key, value in node.value:
        if key.value not in model.model_fields:
            continue
        field = model.model_fields[key.value]
        unit, kind = read_facts(field)["unit"], bare_type(field.annotation)
        if unit:
            yield key.start_mark.line, unit
        elif is_section(kind) and isinstance(value.value, list):  # not null
            yield from _find_units(value, kind)
        elif get_origin(kind) is dict and is_section(get_args(kind)[1]):  # sections by name
            for _, section in value.value:
                yield from _find_units(section, get_args(kind)[1])
