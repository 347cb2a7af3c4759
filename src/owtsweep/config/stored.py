"""Write and read config.yaml, the file in a run's folder with all keys of its configuration.

A run's folder may come from another person. A stored configuration is therefore refused if it
contains an interpolation (`${...}`) or an alias (`*name`). `dump_with_units` writes for readers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, get_args, get_origin

from owtsweep.config.common import Config
from owtsweep.config.hints import hydra_in_one_line
from owtsweep.config.section import Plain, Section, bare_type, is_section, read_facts
from owtsweep.config.typed import as_mapping
from owtsweep.errors import InputError, require
from owtsweep.io.reading import read_text

if TYPE_CHECKING:
    import yaml

#: Most bytes of a stored configuration. The largest grid needs a hundredth of this.
MOST_BYTES = 10_000_000
#: The lists and mappings of a stored configuration may be nested at most this deep.
DEEPEST = 20
#: Most mappings and most values of a stored configuration: a thousand values take some 0.1 s.
MOST_MAPPINGS, MOST_VALUES = 2000, 200_000


def dump(config: Config) -> str:
    from omegaconf import OmegaConf

    return OmegaConf.to_yaml(OmegaConf.create(as_mapping(config)))


def read(path: Path, *, resolve: bool = True) -> Plain:
    """Return the content of a trusted YAML file; with `resolve`, interpolations are replaced.

    Raise `InputError` if the file cannot be read, is no YAML, or does not hold a mapping of keys.
    """
    from omegaconf import OmegaConf

    with naming(path):
        return resolved(OmegaConf.load(path), resolve=resolve)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Turn any error inside the context into an `InputError` that names the YAML file `path`."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except Exception as error:  # the errors of the YAML library have no common base class
        text = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a configuration ({text})") from error


def read_stored(path: Path) -> tuple[Plain, str]:
    """Return the content of a stored config.yaml, as plain data and as text.

    Raise `InputError` if there is no file, or it is too large, is not a mapping of keys, or
    contains an interpolation, an alias or too many values. An interpolation (`${...}`) could read
    environment variables of the user. An alias (`*name`) can stand for more data than fit into
    memory.
    """
    from omegaconf import OmegaConf

    text = read_text(path, MOST_BYTES)
    with naming(path):
        check_events(text, MOST_VALUES, aliases=False)
        plain = resolved(OmegaConf.load(StringIO(text)), resolve=False)
    require(
        "${" not in json.dumps(plain, default=str),
        f"{path}: it holds an interpolation (${{...}}); a stored configuration holds values",
    )
    return plain, text


def check_events(text: str, most: int, *, aliases: bool) -> None:
    """Raise `InputError` if a YAML text nests too deeply or holds more than `most` values.

    With `aliases`, an alias (`*name`) counts as the values for which it stands; else it is refused,
    and so are more than `MOST_MAPPINGS` mappings.
    """
    import yaml

    sizes: dict[str | None, int] = {}  # anchor -> number of values that it names
    open_lists: list[tuple[str | None, int]] = []  # anchor, and `values` at its start
    values = mappings = 0
    for event in yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
        if isinstance(event, yaml.AliasEvent):
            require(aliases, "it holds an alias (*name); a stored configuration holds values")
            values += sizes.get(event.anchor, most)  # unfinished: it holds itself
        elif isinstance(event, yaml.ScalarEvent):
            values += 1
            sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionStartEvent):
            open_lists.append((event.anchor, values))
            sizes.pop(event.anchor, None)
            mappings += isinstance(event, yaml.MappingStartEvent)
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_lists.pop()
            values += 1
            sizes[anchor] = values - before
        require(len(open_lists) <= DEEPEST, f"its lists and mappings lie more than {DEEPEST} deep")
        if aliases:
            require(
                values <= most,
                f"its aliases (*name) stand for more than {most} values; write fewer",
            )
        else:
            require(
                mappings <= MOST_MAPPINGS and values <= most,
                f"it holds more than {MOST_MAPPINGS} mappings or {most} values",
            )


def resolved(mapping: object, *, resolve: bool = True) -> Plain:
    """Return the content of an OmegaConf object; with `resolve`, interpolations are replaced.

    Raise `InputError` if the object is not a mapping, or an interpolation cannot be replaced, for
    example because it names a missing key.
    """
    from omegaconf import OmegaConf

    with hydra_in_one_line():
        plain = OmegaConf.to_container(mapping, resolve=resolve)
    if not isinstance(plain, dict):
        raise InputError("config: this is a list, not a mapping of keys")
    return {str(key): value for key, value in plain.items()}


def dump_with_units(config: Config) -> str:
    """Return the YAML text of `dump` with units as comments such as `# m/s^2` behind the keys."""
    import yaml

    text = dump(config)
    lines = text.splitlines()
    for line, unit in _find_units(yaml.compose(text, Loader=yaml.SafeLoader), type(config)):
        lines[line] += f"  # {unit}"
    return "\n".join([*lines, ""])


def _find_units(node: yaml.MappingNode, model: type[Section]) -> Iterator[tuple[int, str]]:
    """Yield the line number and the unit of each key of a section's YAML node that has a unit."""
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
